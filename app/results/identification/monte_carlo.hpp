#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "identification/assessment/monte_carlo.hpp"

namespace poise::app {

/// The errors of many simulated fits against the Cramer-Rao bound and against the standard errors that the fits state.
Result monte_carlo_result(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                          const std::vector<std::string>& settings);

/// What theory expects of the errors, and what was found: of every parameter, then of every combination. None where
/// nothing is identifiable.
std::vector<Panel> monte_carlo_panels(const MonteCarlo& answer);

}  // namespace poise::app
