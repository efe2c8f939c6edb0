#pragma once

#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/results/identification/identify.hpp"

namespace poise::app {

/// For each of the first sensors one column of charts: the worst run as read and as fitted, residuals of the worst
/// runs, and the relative sensitivities of the worst run. To be drawn with fit_columns() side by side.
std::vector<Panel> fit_panels(const FitProblem& problem, const FitAnswer& answer);
int fit_columns(const Experiment& experiment);

}  // namespace poise::app
