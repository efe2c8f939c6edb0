#pragma once

#include <string>

#include "app/palette.hpp"
#include "comparison/work_precision.hpp"

namespace poise::app {

/// What `poise compare --tolerances` prints: what each method takes to reach some errors, then all its runs. Tolerances
/// next to each other that led to the very same run share a line, with the median of their times.
std::string work_precision_report(const StaticModel& model, const comparison::WorkPrecision& result,
                                  const comparison::WorkPrecisionOptions& options, const Palette& palette);

}  // namespace poise::app
