#pragma once

// The search for the best minimum of a fit.

#include <string>
#include <vector>

#include "identification/fit/private/minimise.hpp"

namespace poise {

/// The best minimum that a search has found, not reached where there is none, and what it says of the fit.
struct FoundMinimum {
  Minimum best;
  std::string start;                        ///< Fit::start
  std::vector<Alternative> alternatives{};  ///< as good as the best one, which is the first; empty where it is alone
  bool is_aliased = false;                  ///< the readings' times allow other frequencies than those of the minimum
  FitStatus status = FitStatus::not_run;    ///< failed and interrupted are the search's own to say
  std::string why{};                        ///< of these two
};

/// Searches from all starts that fit() names.
FoundMinimum search_minimum(const FitTask& task, const Weighting& weighting, FitEffort& effort);

/// Goes on from another fit (FitOptions::from), without a search; `weighting` is that fit's.
FoundMinimum continue_fit(const FitTask& task, const Weighting& weighting, FitEffort& effort);

}  // namespace poise
