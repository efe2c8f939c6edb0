#pragma once

#include <optional>
#include <vector>

#include "statics/all_equilibria/private/merged_mechanism.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// What equilibria there are around a pose x* where c of the rows that hold, s, depend on the others, R: a change
/// point, where branches of motion cross.
///
/// With coordinates D that R gives from the others, p, and h = p - p*, a closed pose x of a box around x* has
///   x_D - x*_D = Z h + r,                             J_R(x*..x) (Z h + r) = -c_R(x*),
///   0 = l_k + g_k . h + h^T K_k h / 2,                K_k = Z^T L_k'' Z,
/// L_k = c_k + lambda_k . c_R with the multipliers that cancel its derivatives by D at x*; there l_k and g_k vanish but
/// for rounding. In equilibrium some y have
///   e_0 + E h + sum_k y_k (g_k + K_k h) = 0,          E = Z^T (V + mu . c_R)'' Z.
/// Let h = rho u, |u| = 1. The first says which directions u the branches have, and the second that the force
/// e_0 + rho E u is one that joints of that branch bear. Where no u and rho has both, no equilibrium is that far from
/// x*; which is seen in boxes of u, however near to x*, where boxes of h would never be small enough.
class CrossingBranches {
 public:
  /// `rows` hold with values 0.
  CrossingBranches(const StaticModel& model, MergedMechanism& mechanism, std::vector<int> rows);

  struct Region {
    std::vector<double> at;        ///< x*
    std::vector<Interval> around;  ///< a box that contains it
    std::vector<int> across;       ///< p
    double reach = 0.0;            ///< where |p - p*| is less too no equilibrium is outside the core
    std::vector<Interval> core;    ///< a small box that contains x*
    double joint_force = 0.0;      ///< that an equilibrium in the core needs at least, scaled; 0: none is known

    /// Whether `box` is in it.
    bool contains(const std::vector<Interval>& box) const;
  };
  /// Finds the change point next to x and the region around it; empty if there is none, or nothing is known around it.
  /// Needs RoundingUp.
  std::optional<Region> around(const std::vector<double>& x);

 private:
  struct Expansion;
  class Expander;
  bool choose_parts(const std::vector<double>& at);
  bool expand(const std::vector<double>& at, double width, Expansion& out);
  double clear_from(const Expansion& of, double least, double most) const;

  const Mechanism<double>& plain_;
  MergedMechanism& mechanism_;
  Mechanism<Interval> positions_;  // without loads
  std::vector<int> rows_;
  std::vector<int> regular_, lost_;      // R, s
  std::vector<int> dependent_, across_;  // D, p
};

}  // namespace poise
