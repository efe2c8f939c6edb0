#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "identification/monte_carlo.hpp"

namespace poise::app {

/// What so many trials say of the fits. Ratios carry their own standard deviation in n converged trials: bias over
/// bound 1/sqrt(n), root mean square error over bound 1/sqrt(2 n), coverage sqrt(0.95 0.05/n).
std::string monte_carlo_report(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                               const Palette& palette);
std::string monte_carlo_json(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                             const std::vector<std::string>& settings);

}  // namespace poise::app
