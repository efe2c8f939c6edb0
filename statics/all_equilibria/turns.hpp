#pragma once

#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

/// Whether full turns of bodies can change the measure: it is an angle, or a sum with an angle in it, alone or in a
/// profile that does not repeat with each turn.
bool counts_turns(const Measure& measure);

/// Whether the measure is an angle of one body from another or a sum of such angles: linear in the coordinates.
bool is_sum_of_angles(const Measure& measure);

/// Which full turns of a mechanism's angles leave it as it is. Points, and so closures, loads and springs between
/// points, do not change when any coordinate angle makes a full turn; springs, stops and couplings on angles, or on
/// sums with angles in them, can: the part of angles is a sum
///   constant + sum_i c_i x_i
/// of coordinates, which turns by k_i change by 2 pi sum_i c_i k_i. A constant torque is the same at every turn, and so
/// is the lift of a cam.
class Turns {
 public:
  explicit Turns(const StaticModel& model);

  /// Whether a spring or stop acts on an angle.
  bool count() const { return !told_.empty(); }
  /// Whether a coordinate changes such an angle.
  bool count(int coordinate) const;

  /// The largest difference of coordinates (rad or mechanism sizes) of a from b turned fully so as to be next to a;
  /// infinite where springs or stops tell that turn apart.
  double distance(const std::vector<double>& a, const std::vector<double>& b) const;

  /// The same pose with every angle in [-pi, pi] that no spring or stop binds to the ground; angles that are bound to
  /// each other turn together.
  std::vector<double> reduced(std::vector<double> x) const;

 private:
  struct Term {
    int coordinate;
    double factor;
  };
  using Angle = std::vector<Term>;

  int angles_ = 0;           // that are kept
  std::vector<Angle> told_;  // that springs and stops act on
  std::vector<int> group_;   // per angle: the first of those that turn together, or -1: bound to the ground
};

}  // namespace poise
