#pragma once

// Summaries of runs at many tolerances.

#include <string>
#include <vector>

#include "comparison/work_precision.hpp"

namespace poise::comparison {

/// How a run ended: "confirmed" (converged, and confirmed by the check), "too coarse" (converged, but not within the
/// check's bounds), "elsewhere", "not converged".
std::string status_of(const WorkPrecisionRow& row);

/// Whether some run is "confirmed".
bool any_confirmed(const WorkPrecision& result);

/// Tolerances next to each other that led one method to the very same answer.
struct ToleranceSpan {
  const WorkPrecisionRow* loosest;
  const WorkPrecisionRow* tightest;
  double microseconds;  ///< median over those tolerances
};

/// All of them, method by method. `result` must outlive them.
std::vector<std::vector<ToleranceSpan>> tolerance_spans(const WorkPrecision& result);

}  // namespace poise::comparison
