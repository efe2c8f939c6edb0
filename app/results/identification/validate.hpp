#pragma once

#include <string>
#include <vector>

#include "app/results/identification/identify.hpp"
#include "identification/assessment/validation.hpp"

namespace poise::app {

/// What the parameters of a fit predict of other records: held-out errors beside the fit's own, then residuals as
/// identify_result() has them. `answer` holds the validation's fit.
Result validation_result(const FitProblem& problem, const Identification& answer, const Validation& validation,
                         const FittedModel& model, Starts starts, const std::vector<std::string>& settings);

}  // namespace poise::app
