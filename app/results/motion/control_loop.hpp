#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "motion/control_loop.hpp"

namespace poise::app {

/// "stable", "marginal" or "unstable".
const char* name_of_stability(const ControlLoop& loop);

/// "No equilibrium ...: why", of a loop that is not known.
std::string no_equilibrium_in_words(const Scene& scene, const ControlLoop& loop);

/// What `poise modes` shows of a mechanism with controllers or blades: its poles, whether it is stable, its linear
/// system.
Result control_loop_result(const MotionModel& model, const ControlLoop& loop, const std::vector<std::string>& settings);

}  // namespace poise::app
