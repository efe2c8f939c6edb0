#pragma once

#include <string>
#include <vector>

#include "app/json.hpp"
#include "identification/fit_problem.hpp"
#include "identification/identifiability.hpp"

namespace poise::app {

/// {poise, experiment: {file, title, source, scene, set, simulated}, units, runs, readings, parameters, nuisances}.
Json json_experiment(const FitProblem& problem, const std::vector<std::string>& settings);

/// {ok, why, rank, gap, singular_values, correlation, untold}: no value of any parameter. Correlations of parameters
/// that are not told are null.
Json json_identifiability(const FitProblem& problem, const Identifiability& known);

}  // namespace poise::app
