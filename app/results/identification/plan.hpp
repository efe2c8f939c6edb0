#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/result/result.hpp"
#include "identification/assessment/plan.hpp"

namespace poise::app {

/// The planned runs and the standard errors that they allow, run by run, beside those of the experiment as it is.
Result plan_result(const FitProblem& problem, const ExperimentText& text, const PlanOptions& options, const Plan& plan,
                   double microseconds, const std::vector<std::string>& settings);

/// The standard errors over the values as runs are added. None where nothing is identifiable.
std::vector<Panel> plan_panels(const FitProblem& problem, const Plan& plan);

}  // namespace poise::app
