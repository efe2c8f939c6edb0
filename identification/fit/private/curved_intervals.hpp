#pragma once

// Intervals where the cost is no parabola.

#include <optional>

#include "identification/fit/private/linear_fit.hpp"
#include "identification/fit/private/noise_estimate.hpp"

namespace poise {

/// Says whether lower costs beside the fit, other minima and single runs may put it in question: it is usable, and no
/// step of another fit, nor without checks.
bool is_to_be_questioned(const FitTask& task, const Fit& fitted);

/// Replaces intervals of a fit that is_to_be_questioned() by those of find_curvature(), and withholds estimates whose
/// intervals do not end. Where that finds a lower cost, returns the minimum it leads to, and leaves the fit as it is.
std::optional<Minimum> correct_for_curvature(const FitTask& task, const WeightedMinimum& at, const LinearFit& linear,
                                             Fit& fitted, FitEffort& effort);

}  // namespace poise
