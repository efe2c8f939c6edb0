#pragma once

// Minima far from that of a fit, of mechanisms that move alike. Where the fit's checks have taken as much as they may,
// the fit says that these were not all sought.

#include <vector>

#include "identification/fit/private/noise_estimate.hpp"

namespace poise {

/// Finds minima from parameters with the frequencies of the minimum, where the sensors do not read all states: the same
/// readings may then be those of another mechanism in other states. Returns the most likely of those that differ from
/// each other by more than the intervals of `fitted` say.
std::vector<Minimum> minima_with_other_states(const FitTask& task, const WeightedMinimum& at, Fit& fitted,
                                              FitEffort& effort);

/// Finds minima from twins(): other dimensions with which the mechanism moves alike.
std::vector<Minimum> minima_of_twins(const FitTask& task, const WeightedMinimum& at, Fit& fitted, FitEffort& effort);

/// Makes the fit ambiguous where some of these minima are as good as its own, and other than its intervals say; then
/// estimates are withheld that differ between them.
void compare_with(const std::vector<Minimum>& others, const FitTask& task, const WeightedMinimum& at, Fit& fitted);

}  // namespace poise
