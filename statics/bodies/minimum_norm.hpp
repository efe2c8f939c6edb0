#pragma once

#include <memory>

#include <Eigen/SparseCore>

#include "statics/bodies/sparse_least_squares.hpp"

namespace poise {

/// x = A^+ b in double: of all x with least |A x - b| the one of minimum norm. By a dense decomposition up to
/// `dense_limit` columns, beyond by SparseLeastSquares.
class MinimumNorm {
 public:
  /// Keeps a reference to A.
  explicit MinimumNorm(const Eigen::SparseMatrix<double>& a, int dense_limit = 250);
  ~MinimumNorm();

  Eigen::VectorXd solve(const Eigen::VectorXd& b);
  TouchedNullSpace null_space();

 private:
  struct Dense;

  const Eigen::SparseMatrix<double>& a_;
  std::unique_ptr<const Dense> dense_;
  std::unique_ptr<SparseLeastSquares> sparse_;
};

}  // namespace poise
