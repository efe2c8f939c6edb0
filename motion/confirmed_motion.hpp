#pragma once

#include <optional>
#include <string>

#include "motion/simulate.hpp"

namespace poise {

/// A motion with the estimate of its error.
struct ConfirmedMotion {
  Motion motion;
  /// Estimate of its error: difference() to a motion ten times as accurate. None where one of the two did not complete.
  std::optional<double> error;
  std::string why_unknown{};  ///< where the motion completed without an estimate: why the other did not

  /// The largest error, and the largest energy error, at which the motion still shows where the mechanism goes.
  static constexpr double useful = 1e-2;
  bool confirmed() const { return motion.completed() && motion.energy_error < useful && error && *error < useful; }
};

/// Simulates with the given accuracy and then, where that completes, with a tenth of it; `checking` replaces
/// options.progress in the second run.
ConfirmedMotion simulate_and_confirm(const MotionModel& model, const MotionState& start, MotionOptions options,
                                     std::function<void(double)> checking = {});

}  // namespace poise
