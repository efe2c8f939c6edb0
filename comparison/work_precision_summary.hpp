#pragma once

// What runs at many tolerances come to.

#include <string>
#include <vector>

#include "comparison/work_precision.hpp"

namespace poise::comparison {

/// How a run ended: "confirmed" (claimed, near a known rest, and confirmed by the check), "claimed" (the same, but too
/// coarse for the check's bounds), "another place", "gave up".
std::string status_of(const WorkPrecisionRow& row);

/// Tolerances next to each other that led one method to the very same answer.
struct ToleranceSpan {
  const WorkPrecisionRow* loosest;
  const WorkPrecisionRow* tightest;
  double microseconds;  ///< median over those tolerances
};

/// All of them, method by method. `result` must outlive them.
std::vector<std::vector<ToleranceSpan>> tolerance_spans(const WorkPrecision& result);

}  // namespace poise::comparison
