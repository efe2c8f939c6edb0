#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/assessment/compare_models.hpp"

namespace poise::app {

/// The models side by side: costs, criteria, errors of runs held out, tests of nested models, and which runs gain.
Result compare_models_result(const std::vector<const FitProblem*>& problems, const ModelComparison& answer);

}  // namespace poise::app
