#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/monte_carlo.hpp"

namespace poise::app {

/// The errors of many simulated fits against the Cramer-Rao bound and against the standard errors that the fits state.
Result monte_carlo_result(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                          const std::vector<std::string>& settings);

}  // namespace poise::app
