#pragma once

// What the steps of a fit share.

#include <cmath>
#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// A ratio of residuals to noise above this indicates a local minimum or an incomplete model.
inline constexpr double suspicious_from = 1.3;
/// From here on other starts are tried although the model is in phase with the records: an incomplete model leads from
/// all of them to one minimum.
inline constexpr double doubtful_from = 3.0;

/// What a fit is of and how it is done: the same in all of its steps.
struct FitTask {
  const FitProblem& problem;
  const std::vector<Record>& records;
  const FitOptions& options;
  int readings = 0;  ///< of all records
  int sought = 0;    ///< parameters and nuisances that are not held

  int degrees_of_freedom() const { return readings - sought; }
  /// sqrt(2 cost / degrees of freedom): 1 where the noise explains the residuals.
  double residual_over_noise(double cost) const { return std::sqrt(2 * cost / degrees_of_freedom()); }
  bool stopped() const { return options.interrupt != nullptr && options.interrupt->load(); }
  void say(const std::string& what) const {
    if (options.progress) options.progress(what);
  }
};

/// What a fit has taken so far; every step adds to it.
struct FitEffort {
  int tries = 0;              ///< starts
  int iterations = 0;         ///< of Ceres
  int evaluations = 0;        ///< of all runs, with their sensitivities
  int check_evaluations = 0;  ///< the same to put the minimum in question
  int most_checks = 0;        ///< as many of these are enough

  bool may_check() const { return check_evaluations < most_checks; }
};

}  // namespace poise
