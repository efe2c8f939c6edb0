#pragma once

#include <vector>

#include "identification/experiment/record.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise::benchmarks {

/// Result of a fit by Ceres' numeric differentiation.
struct NumericFit {
  bool converged = false;
  std::vector<double> parameters;  ///< values in the scene, SI
  int iterations = 0;
};

struct NumericFitOptions {
  double relative_step = 1e-6;  ///< of a number in its unit; Ceres' default
  double accuracy = 1e-10;      ///< of the motions, see simulate(); its default
  double function_tolerance = 1e-7;
};

/// The fit with which Poise is compared: the same residuals, parameters, nuisances and tolerances, but Jacobians by
/// ceres::DynamicNumericDiffCostFunction (central differences). Every number is scaled to order one, so that one
/// relative step suits all. Ranges are ignored.
NumericFit fit_numerically(const FitProblem& problem, const std::vector<Record>& records,
                           const std::vector<double>& parameters, const std::vector<std::vector<double>>& nuisances,
                           const NumericFitOptions& options);

}  // namespace poise::benchmarks
