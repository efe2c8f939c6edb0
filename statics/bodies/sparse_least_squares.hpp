#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include "solvers/sparse_ldl.hpp"

namespace poise {

/// The null space of a sparse matrix.
struct TouchedNullSpace {
  int dimension = 0;          ///< singular values below 1e-6, counted by Sylvester's law in the signs of LDL^T pivots
  std::vector<bool> touches;  ///< per unknown: has a component in it
};

/// Least squares with a sparse matrix A (m x n) that may be rank-deficient. Its rows are first normalized. By LDL^T
/// factors of
///
///   [ A_s A_s^T + e I   A_d ]
///   [ A_d^T             -I  ]
///
/// where A_d are the few long columns, whose products would fill the matrix, and A_s all others.
class SparseLeastSquares {
 public:
  explicit SparseLeastSquares(const Eigen::SparseMatrix<double>& a);

  /// x of least norm with minimal |A x - b|, rows normalized, refined until the effect of e vanishes.
  Eigen::VectorXd solve(const Eigen::VectorXd& b);

  /// A x = 0: unknowns with a component in it are not determined by A x = b.
  TouchedNullSpace null_space();
  /// A^T y = 0: rows with a component in it are combinations of others.
  TouchedNullSpace left_null_space();

 private:
  void even_rows();
  void analyse();
  void factor(double shift);
  void apply_inverse(Eigen::VectorXd& b);
  Eigen::VectorXd solve_even(const Eigen::VectorXd& b);
  Eigen::VectorXd refine(Eigen::VectorXd& b);
  void project(Eigen::VectorXd& b);
  int count_small();

  Eigen::SparseMatrix<double> a_;  // rows of length one
  Eigen::VectorXd scale_;          // by which each was multiplied
  int long_columns_ = 0;
  std::vector<int> target_;  // per entry of the matrix to be factored, in the order of for_each_entry
  std::vector<double> right_;
  solvers::SparseLdl factors_;
};

}  // namespace poise
