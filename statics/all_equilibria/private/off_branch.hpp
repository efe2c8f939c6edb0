#pragma once

#include <vector>

#include "statics/all_equilibria/private/interval_matrix.hpp"
#include "statics/all_equilibria/private/merged_mechanism.hpp"
#include "statics/all_equilibria/private/neutral_motions.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Which boxes hold no equilibria but those of a neutral branch (statics/all_equilibria/private/turning_branch.hpp).
///
/// With z_i the angle by which coordinate i is away from where its leader has it on the branch, zeta_i = 2 sin(z_i / 2)
/// and m_i = x_i - z_i / 2, the gap of a loop is, since the sums of its groups vanish,
///   sum_i a_i zeta_i,   a_i = i c_i exp(i m_i).
/// Closed poses of other branches have zeta = rho u, rho > 0, and so  A u = 0,  A of these columns: where A has full
/// rank there are none. The energy does not change along a neutral motion on the branch; so elsewhere, with e the
/// bodies that it turns, its force and the levers of joint forces y are rho times
///   B u,   i A_e u,   B_i = -+ Re(w exp(i (m_g - m_f))) cos(z_other / 2) of the products of the energy,
/// and equilibrium needs  B u + y . (i A_e u) = 0  besides  F + J^T y = 0,  and  u . (F + J^T y) = 0,  in which  J u =
/// (J - A) u  is as small as z. Where u is known in a box but for its size, these are linear in y, and refuse the box
/// where they contradict each other, however near to the branch it is: at change points, where branches cross, too.
class OffBranch {
 public:
  OffBranch(const StaticModel& model, const NeutralMotions& neutral);

  /// `rows`: that hold. Needs RoundingUp.
  bool excludes(const std::vector<Interval>& box, const std::vector<int>& rows, MergedMechanism& mechanism);

 private:
  enum class Direction { none, found, unknown };
  bool place(const std::vector<Interval>& box);
  Direction find_direction();
  void add_balance(const std::vector<int>& rows, const std::vector<Interval>& box, MergedMechanism& mechanism);
  void add_along_direction(const std::vector<int>& rows, std::size_t to);
  void add_motion(int motion, const std::vector<int>& rows, const std::vector<Interval>& box, std::size_t to);

  const NeutralMotions& neutral_;
  const TurningBranch& branch_;
  const Mechanism<double>& plain_;
  std::vector<int> across_;              // coordinates with a z of their own
  std::vector<int> place_;               // of a coordinate in these, or -1
  std::vector<int> motion_;              // of a coordinate, or -1
  std::vector<int> loop_of_row_, part_;  // of constraint rows: index into the branch's loops, or -1; 0 x, 1 y
  double slack_ = 0.0;                   // of gaps by rho
  std::vector<double> effort_slack_;     // of the force along motions by rho
  // Of the box in hand.
  std::vector<Interval> z_, middle_, u_;
  std::vector<Planar<Interval>> column_;  // loops x across
  IntervalMatrix equations_{0, 0};        // in y, the last column is the rest
};

}  // namespace poise
