#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/base_parameters.hpp"
#include "identification/fit_problem.hpp"
#include "identification/identifiability.hpp"

namespace poise::app {

/// Which parameters an experiment determines, and how well, before any fit. Values are those of the scene; `base` is of
/// the mechanism in the first run, and `list_base` shows it in full.
Result identifiability_result(const FitProblem& problem, const Identifiability& known, const BaseParameters& base,
                              bool list_base, const std::vector<std::string>& settings);

}  // namespace poise::app
