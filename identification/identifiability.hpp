#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/fit_problem.hpp"

namespace poise {

/// Which parameters the readings of an experiment determine, by the first-order theory of least squares.
///
/// With A = d(readings / noise)/d(parameters / scale), nuisances eliminated and priors added, Fisher's information is
/// A^T A and no unbiased estimate can have a smaller covariance than its inverse (Cramer and Rao). A singular value of
/// A is the change of all readings together, in standard deviations of the noise, for a change of 100 % along its
/// direction. Nuisances are unknowns of a run of no interest themselves: its initial state, its equilibrium pose.
struct Identifiability {
  /// A direction of the parameters along which the readings do not change, or not measurably.
  struct Direction {
    double singular_value = 0.0;
    bool exact = false;        ///< in the null space of A; else its singular value is below identifiable_from
    bool scale = false;        ///< mainly the common scale of masses, inertias, stiffnesses and damping
    std::vector<double> part;  ///< relative change of every parameter, the largest 1
    std::string words;         ///< the direction and its effect, one sentence
    std::string remedy;        ///< what would make it identifiable
  };
  bool ok = false;
  std::string why;
  std::vector<double> singular_values;  ///< descending
  int rank = 0;                         ///< numerical: singular values above the gap
  double gap = 0.0;                     ///< ratio of the singular values on both sides of it; 0 with full rank
  std::vector<Direction> null_directions;
  std::vector<bool> identifiable;      ///< per parameter: has no part in a null direction
  std::vector<double> standard_error;  ///< per parameter: Cramer-Rao bound, SI; infinite in an exact null direction
  /// Of all parameters, SI, for white noise as stated; of a change in the null space it knows nothing.
  Eigen::MatrixXd covariance;
  /// Of the parameters, [i][j]; empty where a standard error is infinite.
  std::vector<std::vector<std::optional<double>>> correlation;
};

/// A direction is a null direction where a change of 100 % changes all readings together by fewer standard deviations.
inline constexpr double identifiable_from = 3.0;

/// At the given parameters (values in the scene, SI) and, per run, nuisances.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances);

/// The same from the runs' triangles (see FitProblem::triangle), one per run.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<Eigen::MatrixXd>& triangles);

}  // namespace poise
