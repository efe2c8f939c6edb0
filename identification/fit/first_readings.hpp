#pragma once

#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// Nuisances of a run, its start, where that is unknown, replaced by an estimate from its first readings (see
/// RunModel::start_from_readings); `unknowns` as of the run.
std::vector<double> started_from_readings(const RunModel& run, const std::vector<double>& unknowns,
                                          std::vector<double> nuisances, const Record& record);

/// Initial nuisances of a fit: the release where the run states one, else an estimate from the first readings of
/// `record`, which may be empty.
std::vector<double> first_guess(const RunModel& run, const std::vector<double>& unknowns, const Record& record);

/// Per sensor, over all runs: root mean square of predicted - read, SI, at the parameters that were fitted, but with
/// every run started from its own first readings in place of the start that was fitted. Compared with
/// Fit::rms it shows the effect of fitting the starts. Empty where a run cannot be started or moved so.
std::vector<double> rms_from_first_readings(const FitProblem& problem, const Fit& fitted,
                                            const std::vector<Record>& records);

}  // namespace poise
