#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "comparison/work_precision_summary.hpp"

namespace poise::app {

/// What `poise compare --tolerances` shows: the least time of each method to some errors, and its runs; tolerances next
/// to each other that led to the same answer share a line. Errors in rad, or length over mechanism size.
Result work_precision_result(const StaticModel& model, const comparison::WorkPrecision& study, int repeats,
                             const std::vector<std::string>& settings);

/// Error against time, both logarithmic, better to the right and below: a curve for each method through its shared runs
/// that converged, in the order of the tolerances. Errors below 1e-17 are drawn there. The title names methods without
/// a curve.
std::vector<Panel> work_precision_panels(const StaticModel& model, const comparison::WorkPrecision& study);

}  // namespace poise::app
