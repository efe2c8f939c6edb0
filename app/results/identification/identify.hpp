#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "identification/assessment/identify.hpp"

namespace poise::app {

/// The estimates with their standard errors, what is not identifiable, residuals. What is withheld is null in the data,
/// and so are its standard error and its truth; no number of it is in the text.
Result identify_result(const FitProblem& problem, const Identification& answer,
                       const std::vector<std::string>& settings);

/// "phi1 0.00292 rad, phi2 0.00403 rad; all angles 0.00351 rad": root mean squares per sensor, SI.
std::string rms_in_words(const std::vector<double>& rms, const Experiment& experiment);

/// Adds a section on the residuals: in total, of the runs, outliers.
void add_residuals(Group& content, const FitProblem& problem, const Identification& answer);
/// The same as data, with status and effort of the fit.
void add_fit_data(Group& content, const FitProblem& problem, const Identification& answer);

/// Adds the table for CSV, one row for each run and time: run, time, and for every sensor the reading, NAME.prediction
/// and NAME.residual = reading - prediction, in the units of the scene. Empty where no fit was reached.
void add_readings(Result& result, const FitProblem& problem, const Identification& answer);

}  // namespace poise::app
