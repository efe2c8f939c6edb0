#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "identification/identifiability/base_parameters.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise::app {

/// Which parameters an experiment determines, and how well, before any fit. Values are those of the scene; `base` is of
/// the mechanism in the first run, and `list_base` shows it in full.
Result identifiability_result(const FitProblem& problem, const Identifiability& known, const BaseParameters& base,
                              bool list_base, const std::vector<std::string>& settings);

/// The 95 % intervals that estimates would have, over the values in the scene. None where nothing is identifiable.
std::vector<Panel> identifiability_panels(const FitProblem& problem, const Identifiability& known);

}  // namespace poise::app
