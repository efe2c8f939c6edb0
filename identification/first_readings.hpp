#pragma once

#include <vector>

#include "identification/fit.hpp"

namespace poise {

/// Nuisances of a run with its start, where that is unknown, as its first readings tell it (see
/// RunModel::start_from_readings).
std::vector<double> started_from_readings(const RunModel& run, std::vector<double> nuisances, const Record& record);

/// Nuisances to begin with: as the run is released, or, where nothing says how, as its first readings tell. `record`
/// may be empty.
std::vector<double> first_guess(const RunModel& run, const Record& record);

/// Per sensor, over all runs: root mean square of predicted - read, SI, at the parameters that were fitted, but with
/// every run started from its own first readings in place of the start that was fitted. Shows what fitting the starts
/// buys. Empty where a run cannot be started or moved so.
std::vector<double> rms_from_first_readings(const FitProblem& problem, const Fit& fitted,
                                            const std::vector<Record>& records);

}  // namespace poise
