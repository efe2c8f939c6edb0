#pragma once

#include <string>
#include <vector>

#include "statics/equilibrium.hpp"

namespace poise::app {

/// The mechanism where it rests, as a figure for a report (SVG 1.1, UTF-8, no outside resources): bodies, joints,
/// springs, stops, loads in red, joint reactions in blue, all values in the scene's units; the pose at the scaled
/// coordinates `start` as a shadow (left out when empty). `rest` may also be a pose that was not confirmed; the figure
/// then says so.
/// All coordinates of `rest` and `start` must be finite.
std::string draw_svg(const StaticModel& model, const Equilibrium& rest, const std::vector<double>& start);

}  // namespace poise::app
