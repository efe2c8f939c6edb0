#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "statics/all_equilibria/private/box_prover.hpp"
#include "statics/all_equilibria/turns.hpp"

namespace poise {

/// The stiffness K of linear springs on angles, whose forces are K x + K_0.
struct AngleSprings {
  std::vector<Interval> at_zero;  ///< K_0
  std::vector<int> row, column;   ///< of the lower triangle of K
  std::vector<Interval> stiffness;
};

/// Empty if there are springs on angles of another kind.
std::optional<AngleSprings> angle_springs(const StaticModel& model);

/// Bounds of the angles whose turns count, where no loop closes. One that a stop on nothing else limits on both sides
/// is between its limits. The others, x, and the forces y of active stops on angles satisfy
///
///   K x + A^T y = -(forces of everything else) - (those of springs on angles at zero),   A x = limits of these stops
///
/// with K the stiffness of linear springs on angles; the forces of everything else are bounded whatever the angles.
class OpenAngles {
 public:
  OpenAngles(const StaticModel& model, const Turns& turns);

  /// Narrows the box to what these equations leave for any of the cases. False if an angle has no bounds in one.
  bool bound(const std::vector<std::vector<StopState>>& cases, CoordinateBox& box) const;

 private:
  // Row s of the stops: its entries as (coordinate, value).
  std::vector<std::pair<int, Interval>> row_of(int stop) const;
  bool is_on_angle(int stop) const { return is_sum_of_angles(model_.scene().stops[static_cast<std::size_t>(stop)].on); }
  // Narrows the box, and gives the angles that remain without bounds.
  std::vector<int> limit_by_stops(CoordinateBox& box) const;
  // Sums up everything but springs and stops on angles.
  std::vector<Interval> forces(const CoordinateBox& box) const;
  bool solve(const std::vector<StopState>& stops, const std::vector<int>& unknown, const std::vector<Interval>& force,
             CoordinateBox& box) const;

  const StaticModel& model_;
  Mechanism<Interval> mechanism_;
  std::optional<AngleSprings> springs_;
  std::vector<int> told_;  // angles whose turns count
  std::vector<Interval> at_zero_, jacobian_;
};

}  // namespace poise
