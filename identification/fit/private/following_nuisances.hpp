#pragma once

// Nuisances that go with other parameters than those of a minimum.

#include <vector>

#include "identification/fit/private/minimise.hpp"

namespace poise {

/// Moves the nuisances of `from` to where the cost with other parameters, linearised, is least, and returns that point
/// and its cost: small motions are linear in their starts. `frequencies` are those about `from`. The point is not
/// reached where a motion fails.
Minimum with_following_nuisances(const FitTask& task, const Weighting& weighting, const FitPoint& from,
                                 std::vector<double> parameters, const Frequencies& frequencies);

}  // namespace poise
