#pragma once

// A fit as files: JSON, a table of residuals, charts.

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "identification/fit.hpp"

namespace poise::app {

/// A fit, and the records that were fitted.
struct FitAnswer {
  Fit fit;
  std::vector<Record> records;
  /// Per sensor, SI: rms_from_first_readings() of measured runs; empty where not asked or not to be had.
  std::vector<double> rms_from_readings;
};

/// Values in the units of the scene. What is withheld is null, and so is its deviation and its truth.
std::string fit_json(const FitProblem& problem, const FitAnswer& answer, const std::vector<std::string>& settings);
/// One line for each run and time: run, time, and for every sensor reading, prediction and residual = reading -
/// prediction, in the units of the scene.
std::string residuals_csv(const FitProblem& problem, const FitAnswer& answer);
/// For each of the first sensors one column of charts: the worst run as read and as fitted, residuals of the worst
/// runs, and what the parameters do to the readings of the worst run. To be drawn with plot_columns().
std::vector<Panel> fit_panels(const FitProblem& problem, const FitAnswer& answer);
int plot_columns(const Experiment& experiment);

}  // namespace poise::app
