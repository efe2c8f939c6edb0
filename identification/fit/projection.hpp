#pragma once

#include <utility>

#include <Eigen/Core>

#include "solvers/linear_algebra.hpp"

namespace poise {

/// What the columns of N do not explain of those of A, of as many rows:  A - Q Q^T A,  Q an orthonormal basis of the
/// columns of N. A itself where N has none.
inline Eigen::MatrixXd unexplained(Eigen::MatrixXd a, const Eigen::MatrixXd& n) {
  if (n.cols() == 0) return a;
  const Eigen::MatrixXd basis = solvers::orthonormal_columns(n);
  a -= basis * (basis.transpose() * a);
  return a;
}

}  // namespace poise
