#pragma once

#include <vector>

#include "model/planar.hpp"
#include "solvers/interval.hpp"
#include "statics/all_equilibria/private/merged_energy.hpp"

namespace poise {

using solvers::Interval;

/// A branch of closed poses on which bodies of loops turn together, as the cranks of a parallelogram do, or keep their
/// angle, as its coupler does: of any turns of these groups the sums of phasors of each group are zero in every loop,
/// so that all loops are closed.
struct TurningBranch {
  /// Of every coordinate the first of its group, itself where it is that or in no loop, -1 where it keeps its angle.
  std::vector<int> leader;
  std::vector<char> is_in_loop;
  std::vector<Interval> apart;         ///< on the branch: its angle from that of its leader, or its angle
  std::vector<Planar<Interval>> turn;  ///< exp(i apart)
  using Loop = std::vector<PlaceTerm<Interval>>;
  std::vector<Loop> loops;  ///< scaled gaps, for all numbers that round to those of the scene
  /// Bound of the scaled gaps on the branch: 0 where the numbers of the scene cancel as they are written.
  double gap = 0.0;

  /// Whether every coordinate of a loop is within `by` of the branch, rad, full turns left out.
  bool contains(const std::vector<double>& x, double by) const;
};

}  // namespace poise
