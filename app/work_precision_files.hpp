#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "comparison/work_precision_summary.hpp"

namespace poise::app {

// What `poise compare --tolerances` writes. Errors in rad or length over mechanism size, times in microseconds.

/// One row for each method and tolerance. Columns: method, status, tolerance, microseconds, error, iterations,
/// evaluations, claimed, confirmed (1 or 0), repeats, rest (counted from 1). No error and rest where none is near.
std::string work_precision_csv(const comparison::WorkPrecision& result);

/// A JSON object: poise, scene {file, title, source, set}, left_out [what statics left out, and why], rests [{digits,
/// stability, neutral, accuracy, found_by, coordinates [{name, unit, value}]}], refused [{method, why}], methods
/// [{method, runs [{tolerance, status, claimed, confirmed, rest, error, microseconds, repeats, iterations, evaluations,
/// why}]}].
std::string work_precision_json(const StaticModel& model, const comparison::WorkPrecision& result,
                                const std::vector<std::string>& settings);

/// Error against time, both logarithmic, better to the right and below: a curve for each method through its shared runs
/// that arrived, in the order of the tolerances. Errors below 1e-17 are drawn there. The title names methods without a
/// curve.
std::vector<Panel> work_precision_panels(const StaticModel& model, const comparison::WorkPrecision& result);

}  // namespace poise::app
