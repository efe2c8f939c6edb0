#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise::app {

/// What `poise sensitivity` shows: for each quantity the `top` numbers that move it most (0: all), one sentence each.
/// They are ranked by the effect of a change of a length by a thousandth of the mechanism's size, of an angle by a
/// thousandth of a radian, of any other number by a thousandth of itself.
Result sensitivity_result(const Scene& scene, const Sensitivities& found, int top,
                          const std::vector<std::string>& settings);

}  // namespace poise::app
