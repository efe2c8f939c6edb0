#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Which parameters the readings of an experiment determine, by the first-order theory of least squares.
///
/// A null is a direction of the parameters along which no reading changes. Structural nulls change no motion of the
/// mechanism whatever the runs do (structural_nulls.hpp); further ones are nulls of these runs only, found by a gap in
/// the singular values of A = d(readings / noise)/d(parameters), nuisances eliminated and priors added. A parameter
/// that has a part in any null has no estimate of its own; combinations of such parameters that no null changes have,
/// where all of the parameters that share the null enter the equations linearly: with a length among them the null
/// curves, and no sum of parameters is constant along it.
/// On the complement of the nulls Fisher's information is A^T A and no unbiased estimate can have a smaller covariance
/// than its inverse (Cramer and Rao). Nuisances are unknowns of a run of no interest themselves: its initial state, its
/// equilibrium pose.
///
/// Finite standard errors are judged by the scale of each parameter (FitProblem::scale_of). With one above a third of
/// its own size a parameter is not identifiable; above a third of a scale that the experiment gives it is poorly
/// determined. Without a scale there is no such judgement.
struct Identifiability {
  /// A direction of the parameters along which the readings do not change, or not measurably.
  struct Direction {
    double singular_value = 0.0;
    bool exact = false;         ///< a null; else a direction with too little effect
    bool structural = false;    ///< a null of the equations of motion; else of these runs
    bool scale = false;         ///< mainly the common scale of masses, inertias, stiffnesses and damping
    std::vector<double> part;   ///< change of every parameter relative to its scale, the largest 1; 0 has no part in it
    std::vector<double> error;  ///< of a null: bounds of the errors of these parts; else empty
    std::string words;          ///< the direction and its effect, one sentence
    std::string remedy;         ///< what would make it identifiable
  };
  /// A function of parameters that no null changes:  sum of coefficient x parameter, or that sum over one more
  /// parameter where the sum alone is zero, because a null is a common factor of all.
  struct Combination {
    std::vector<double> coefficient;  ///< per parameter, SI
    int over = -1;                    ///< the parameter that divides
    int unit_of = -1;                 ///< to be shown in the unit of this one (over that of the other)
    double value = 0.0;               ///< SI
    double standard_error = 0.0;      ///< SI: Cramer-Rao bound; in a Fit the leading one of StandardErrors
    std::string words;                ///< "k / m", "J + 0.25 m"

    /// Its value at shown values of the parameters, SI.
    double at(const std::vector<double>& shown) const;
    /// The derivatives of that.
    Eigen::VectorXd gradient(const std::vector<double>& shown) const;
  };
  bool ok = false;
  std::string why;
  std::vector<double> singular_values;  ///< descending: change of the readings for a change of a scale; nulls last
  int rank = 0;                         ///< parameters less nulls
  int structural_nulls = 0;             ///< by the equations of motion
  int other_nulls = 0;                  ///< of these runs
  int unclear = 0;  ///< further directions whose effect is below errors of computation, without a gap: treated as nulls
  double gap = 0.0;  ///< ratio of the singular values on both sides of the nulls; 0 with full rank
  std::vector<Direction> null_directions;
  std::vector<Combination> combinations;
  std::vector<bool> identifiable;  ///< per parameter: no part in a null, and a standard error that its scale allows
  std::vector<bool> poorly_determined;  ///< per parameter: identifiable, but its standard error is large
  std::vector<double> standard_error;   ///< per parameter: Cramer-Rao bound, SI; infinite where it has a part in a null
  /// Of all parameters, SI, for white noise as stated; of changes in the nulls it knows nothing.
  Eigen::MatrixXd covariance;
  /// Of the parameters, [i][j]; empty where a standard error is infinite. In a Fit those of the leading errors.
  std::vector<std::vector<std::optional<double>>> correlation;
};

/// Scales per standard error, below which a parameter is poorly determined.
inline constexpr double identifiable_from = 3.0;

/// At the given parameters (values in the scene, SI) and, per run, nuisances.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances);

/// The same where the runs' triangles are known (see FitProblem::triangle), one per run, with readings weighted so.
Identifiability assess(const FitProblem& problem, const std::vector<double>& parameters,
                       const std::vector<std::vector<double>>& nuisances, const std::vector<Eigen::MatrixXd>& triangles,
                       const Weighting& weighting);

}  // namespace poise
