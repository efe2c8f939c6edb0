#pragma once

// What the residuals of a fit say of it.

#include <string>

#include "identification/fit/private/fit_task.hpp"

namespace poise {

/// Probability that one of the tests of a fit whose residuals are as stated says they are not.
inline constexpr double chance_level = 1e-3;

struct FitVerdict {
  FitStatus status = FitStatus::converged;
  std::string why;  ///< empty where it is converged
};

/// Judges a fit: ambiguous where it has alternatives; else converged if the residuals of every stated noise, in total
/// and in every run, are as large as it says; misfit if they are not, and failed where they are larger and
/// `is_aliased`: the readings' times allow other frequencies. `fitted` has its errors, its noise and its number of
/// tries.
FitVerdict verdict_on(const FitProblem& problem, const Fit& fitted, bool is_aliased);

}  // namespace poise
