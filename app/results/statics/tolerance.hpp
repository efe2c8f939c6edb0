#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "statics/sensitivity/tolerance.hpp"

namespace poise::app {

/// What `poise tolerance` shows: for each quantity its bands of first and second order and of samples, what each
/// tolerance contributes, and the histogram of the samples.
Result tolerance_result(const Scene& scene, const ToleranceStudy& study, const std::vector<std::string>& settings);

/// The histogram of each quantity, with the normal density of first order.
std::vector<Panel> histogram_panels(const Scene& scene, const ToleranceStudy& study);

}  // namespace poise::app
