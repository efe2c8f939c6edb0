#pragma once

#include <cstddef>
#include <vector>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// A reading that no scatter of the others explains.
struct Outlier {
  std::size_t run = 0, sensor = 0;
  double time = 0.0;      ///< s
  double residual = 0.0;  ///< read - fitted, SI
  double size = 0.0;      ///< |residual| over the scale of the sensor's residuals
};

/// Readings whose residuals exceed 6 times the scale of their sensor's (see robust_scale()), and differ so from the
/// median of the five residuals before and the five after: the error of a model, which changes slowly, is none. In the
/// order of runs, sensors and times. `runs`: linearized at the fit, of all runs.
std::vector<Outlier> outliers(const FitProblem& problem, const std::vector<LinearRun>& runs,
                              const Weighting& weighting);

/// Readings that differ from the median of their neighbours by more than 6 times what is usual, replaced by it: a
/// record for first guesses.
Record without_outliers(const Record& record);

}  // namespace poise
