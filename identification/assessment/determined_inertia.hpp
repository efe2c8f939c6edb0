#pragma once

#include <vector>

#include "identification/assessment/identify.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise {

/// Of the base parameters of the scene (base_parameters()) those that the readings determine, where they leave masses,
/// places of their centres and inertias open of which these are made: SI, with their intervals. None where
/// Identifiability::combinations tell it, or of experiments of several parts.
std::vector<PredictedResult> determined_inertia(const FitProblem& problem, const Identification& answer);

}  // namespace poise
