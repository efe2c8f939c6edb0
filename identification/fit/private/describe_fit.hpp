#pragma once

// Everything that a Fit says of its minimum.

#include "identification/fit/private/linear_fit.hpp"
#include "identification/fit/private/noise_estimate.hpp"
#include "identification/fit/private/start_search.hpp"

namespace poise {

/// Describes a minimum by the runs linearized there: estimates with their standard errors and intervals, residuals, and
/// the verdict on them, unless the search has one. `found` may have another minimum than `at`.
Fit describe_fit(const FitTask& task, const FoundMinimum& found, const WeightedMinimum& at, const LinearFit& linear,
                 const FitEffort& effort);

/// Takes the values alone over: cost, parameters, nuisances; none of these where no minimum was reached.
Fit values_of_fit(const FitTask& task, const FoundMinimum& found, const WeightedMinimum& at, const FitEffort& effort);

/// States what the fit has taken.
void set_effort(Fit& fit, const FitEffort& effort);

/// Says, once, that this has not put the minimum in question.
void leave_out(Fit& fit, const std::string& what);

/// Says that a parameter is not identifiable, and why.
void withhold(Fit& fit, std::size_t parameter, const std::string& why);

}  // namespace poise
