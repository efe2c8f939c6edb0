#pragma once

#include <atomic>
#include <functional>

#include <Eigen/Core>

namespace poise::solvers {

/// Residuals r at x and their derivatives, one row per residual.
struct ResidualsAt {
  Eigen::VectorXd value;
  Eigen::MatrixXd by;
};

/// Evaluates r at x, with its derivatives where these are asked for; false where r has no value there.
using ResidualFunction = std::function<bool(const Eigen::VectorXd& x, bool with_derivatives, ResidualsAt& out)>;

struct BoundedLeastSquaresOptions {
  int iterations = 60;         ///< steps that are tried, at most
  double good_enough = 1e-24;  ///< ends where |r|^2 is at most that
  double least_gain = 1e-10;   ///< ends where three steps in turn lower |r|^2 by less than that part of it
  double first_damping = 1e-3;
  const std::atomic<bool>* interrupt = nullptr;
};

struct BoundedLeastSquaresResult {
  Eigen::VectorXd x;
  double sum = 0.0;    ///< |r|^2 at x; infinite where r has no value at the start
  int iterations = 0;  ///< steps tried
};

/// Searches a local minimum of |r(x)|^2 over  lower <= x <= upper  by the method of Levenberg and Marquardt: steps
///
///   (J^T J + d diag(J^T J + e)) dx = -J^T r
///
/// over the variables that no bound stops (D. P. Bertsekas, "Projected Newton methods", 1982), cut at the bounds; the
/// damping d falls where a step succeeds and grows where it does not, or where r has no value. r may have kinks where
/// it is zero (hinges). Both directions of steps depend on x and r alone, so that results are the same on all machines.
BoundedLeastSquaresResult bounded_least_squares(const ResidualFunction& residuals, const Eigen::VectorXd& x,
                                                const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                const BoundedLeastSquaresOptions& options = {});

}  // namespace poise::solvers
