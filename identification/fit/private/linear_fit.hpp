#pragma once

// A fit about its minimum.

#include <vector>

#include "identification/fit/private/minimise.hpp"

namespace poise {

/// The runs linearized at a minimum, and what follows from that of the parameters.
struct LinearFit {
  std::vector<LinearRun> runs;
  Identifiability identifiability;
  StandardErrors errors;  ///< empty where a motion fails (identifiability.ok is false)
};

/// Linearizes all runs at a minimum; those that the descent has computed there already are taken from it.
LinearFit linearize(const FitTask& task, const Weighting& weighting, Minimum& at);

/// Returns e of a run, per sensor.
Residuals residuals_in(const LinearRun& run);

}  // namespace poise
