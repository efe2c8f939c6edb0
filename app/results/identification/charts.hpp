#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/results/identification/identify.hpp"

namespace poise::app {

/// For each sensor, those of one unit together, a row of charts: the worst run as read and as fitted, residuals of the
/// worst runs, and the relative sensitivities of the worst run, over one time axis for each column. Of many sensors
/// those with the largest residuals are drawn, of many parameters those with the largest relative standard errors. To
/// be drawn with fit_columns() side by side.
std::vector<Panel> fit_panels(const FitProblem& problem, const FitAnswer& answer);
/// What these leave out: a line on sensors, a line on parameters.
std::vector<std::string> not_drawn(const FitProblem& problem, const FitAnswer& answer);
int fit_columns(const Experiment& experiment);

}  // namespace poise::app
