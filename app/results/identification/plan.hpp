#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/plan.hpp"

namespace poise::app {

/// The planned runs and the standard errors that they allow, run by run, beside those of the experiment as it is.
Result plan_result(const FitProblem& problem, const ExperimentText& text, const PlanOptions& options, const Plan& plan,
                   double microseconds, const std::vector<std::string>& settings);

}  // namespace poise::app
