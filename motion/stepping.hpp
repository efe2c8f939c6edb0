#pragma once

// Numbers that the steps of a motion share (motion/simulate.cpp). Private to the motion.

#include <limits>

namespace poise::stepping {

inline constexpr double eps = std::numeric_limits<double>::epsilon();
inline constexpr double tiny = std::numeric_limits<double>::min();  ///< in place of zero where something is divided
/// Margin of friction beyond which an event has passed: rounding at its start leaves less.
inline constexpr double past = 1e-12;
/// Other independent coordinates are chosen if the pivot has decreased below this.
inline constexpr double good_pivot = 0.05;
/// The poses of the last stages of a step are approximations, which may lie beyond a border that the step ends at,
/// where other formulas hold: an error in proportion to the step. So do those of the stages of Fehlberg's formula at
/// the beginning of a step that begins there. So many steps become shorter towards a border, each by this factor, and
/// longer behind it.
inline constexpr int steps_at_border = 2;
inline constexpr double shorter_at_border = 0.01;

}  // namespace poise::stepping
