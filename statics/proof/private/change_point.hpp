#pragma once

#include <vector>

#include <Eigen/Core>

#include "statics/proof/stability.hpp"

namespace poise {

/// A constraint row t that depends on others at a configuration, on the tangents Z of those others.
struct LostRow {
  Eigen::RowVectorXd gradient;  ///< of t, times Z
  Eigen::MatrixXd second;       ///< T = Z^T t'' Z, with the multipliers of the others that cancel the gradient
  double open = 0.0;            ///< greatest |t|
};

struct ChangePoint {
  /// Some row depends on the others to second order no more, here or so near that a gap of `open` tells no difference.
  bool loses_rank = false;
  Stability stability = Stability::unknown;
  double spread = 0.0;  ///< how far from here equilibria may lie that belong to it, rad or mechanism sizes
};

/// The energy at a configuration where rows are lost. Motions z are those tangent to the set where the lost rows vanish
/// to second order, z^T T z = 0. With H the reduced Hessian, the energy grows along all of them if H + nu T is positive
/// definite for some nu, and not if for a single lost row it is indefinite for all nu (Finsler's lemma; double, with a
/// margin of 1e-7). Rows that vanish to second order, to rounding, repeat others: they may take no part in where rank
/// is lost, and only that the energy grows is said beside them. Unknown if that decides nothing.
ChangePoint examine_change_point(const Eigen::MatrixXd& h, const std::vector<LostRow>& lost);

}  // namespace poise
