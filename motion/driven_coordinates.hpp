#pragma once

// The drives of a scene as coordinates of a SplitClosure. Private to this library.

#include <string>
#include <vector>

#include "motion/motion_model.hpp"

namespace poise {

/// A driven measure, from SI to a place in the coordinates of a SplitClosure:  x = (value - zero) / unit.
struct DrivenCoordinate {
  int coordinate = -1;
  double zero = 0.0, unit = 1.0;
  bool is_angle = true;
  std::string start{};  ///< the name of its guess in [start], where it is a coordinate of the mechanism

  double scaled(double value) const { return (value - zero) / unit; }
  double value(double x) const { return zero + unit * x; }
};

/// Finds those of all drives. Measures that are no coordinates have their places behind these. Throws InputError where
/// a driven body cannot turn, and where two drives move the same coordinate.
std::vector<DrivenCoordinate> driven_coordinates(const MotionModel& model);

/// Drives whose measures are no coordinates.
std::vector<int> measured_drives(const Scene& scene);

}  // namespace poise
