#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/fit_problem.hpp"

namespace poise {

/// What the readings of an experiment can tell of its parameters, by the first-order theory of least squares.
///
/// With A = d(readings / noise)/d(parameters / scale), nuisances eliminated and priors added, Fisher's information is
/// A^T A and no unbiased estimate can have a smaller covariance than its inverse (Cramer and Rao). A singular value of
/// A is how many standard deviations of noise a change of 100 % along its direction makes in all readings together.
struct Identifiability {
  /// A direction of the parameters that the readings do not tell.
  struct Direction {
    double singular_value = 0.0;
    bool exact = false;        ///< nothing depends on it; else only too little
    bool scale = false;        ///< it is, in the main, the common scale of masses, inertias, stiffnesses and damping
    std::vector<double> part;  ///< change of every parameter relative to its scale, largest 1
    std::string words;         ///< what it is
    std::string remedy;        ///< what would break it
  };
  bool ok = false;
  std::string why;
  std::vector<double> singular_values;  ///< descending
  int rank = 0;                         ///< numerical: singular values above the gap
  double gap = 0.0;                     ///< the ratio of the singular values on both sides of it; 0 with full rank
  std::vector<Direction> untold;
  std::vector<bool> told;         ///< per parameter: has no part in an untold direction
  std::vector<double> deviation;  ///< per parameter: least standard deviation, SI; infinite in an exact direction
  /// Of the parameters, [i][j]; empty with those of infinite deviation.
  std::vector<std::vector<std::optional<double>>> correlation;
};

/// Where a change of 100 % makes fewer standard deviations than this in all readings, nothing is told.
inline constexpr double told_from = 3.0;

/// Judges at the given parameters and, per run, nuisances.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances);

/// The same from the runs' triangles (see FitProblem::triangle), one per run.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<Eigen::MatrixXd>& triangles);

}  // namespace poise
