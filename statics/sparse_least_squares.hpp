#pragma once

#include <vector>

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>

namespace poise {

/// Least squares with a sparse matrix A (m x n) that may lack rank, by LDL^T factors of the quasi-definite
/// [I A; A^T -e I].
class SparseLeastSquares {
 public:
  /// `a` must outlive this.
  explicit SparseLeastSquares(const Eigen::SparseMatrix<double>& a);

  /// x of (nearly) least norm with minimal |A x - b|, refined until e does no harm.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  const Eigen::SparseMatrix<double>& a_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors_;
};

/// The null space of a sparse A (m x n), its rows and columns first brought to length one.
struct NullSpace {
  int dimension = 0;          ///< singular values below 1e-6, counted by Sylvester's law in the signs of LDL^T pivots
  std::vector<bool> touches;  ///< per unknown: has a part in it, so that A x = b leaves it undetermined
};

NullSpace null_space(const Eigen::SparseMatrix<double>& a);

}  // namespace poise
