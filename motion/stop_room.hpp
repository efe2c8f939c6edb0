#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "motion/motion_model.hpp"

namespace poise {

/// Position of a pose relative to a stop  min <= g <= max;  rad, or mechanism sizes.
struct StopRoom {
  /// Overrun up to which a pose is at its stop, not beyond: rounding.
  static constexpr double rounding = 1e-9;

  double past_max = 0.0;  ///< g - max
  double past_min = 0.0;  ///< min - g

  double overrun() const { return std::max(past_max, past_min); }  ///< negative: distance left
  bool at_max() const { return past_max >= past_min; }             ///< the max is the nearer of both limits
};

/// One entry per stop of the scene, for scaled coordinates x.
std::vector<StopRoom> stop_rooms(const MotionModel& model, std::span<const double> x);

}  // namespace poise
