#pragma once

#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// A run as fitted. Per sensor, per time; SI. NaN where the motion cannot be computed.
struct RunResiduals {
  std::vector<std::vector<double>> prediction;
  std::vector<std::vector<double>> residual;  ///< reading - prediction
};

RunResiduals residuals_of(const FitProblem& problem, const Fit& fitted, const std::vector<Record>& records,
                          std::size_t run);

/// sqrt(mean over the sensors of (root mean square residual / noise)^2) of one run of a fit, with the noise that it has
/// stated or estimated; NaN where the run's motion could not be computed.
double rms_over_noise(const Fit& fitted, const RunFit& run);

/// Indices of the runs by rms_over_noise(), the largest first; those whose motion could not be computed lead.
std::vector<std::size_t> worst_first(const Fit& fitted);

}  // namespace poise
