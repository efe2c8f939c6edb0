#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "app/draw/figure.hpp"
#include "app/results/identification/identify.hpp"

namespace poise::app {

/// For each sensor, those of one unit together, a row of charts: the worst run as read and as fitted, residuals of the
/// worst runs, and the relative sensitivities of the worst run, over one time axis for each column. Of many sensors
/// those with the largest residuals are drawn, of many parameters those with the largest relative standard errors. To
/// be drawn with fit_columns() side by side.
std::vector<Panel> fit_panels(const FitProblem& problem, const Identification& answer);
/// What these leave out: a line on sensors, a line on parameters.
std::vector<std::string> not_drawn(const FitProblem& problem, const Identification& answer);
int fit_columns(const Experiment& experiment);

/// A page shows the worst runs one by one, each with its readings as fitted and its residuals, the first beside a
/// drawing of the mechanism as the run begins, in which the sensors are marked where they are read; the autocorrelation
/// of the residuals, and the relative sensitivities of the worst run, of the same sensors and parameters.
std::vector<Figure> fit_figures(const FitProblem& problem, const Identification& answer);
/// The 95 % intervals of the estimates that are not withheld: of simulated runs about their truths, each in its own
/// standard error; of measured runs their half widths in per cent of the estimates, on a logarithmic axis.
/// None where standard errors are not known.
std::vector<Figure> estimate_figures(const FitProblem& problem, const Fit& fitted);

}  // namespace poise::app
