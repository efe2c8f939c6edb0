#pragma once

#include <Eigen/Core>

namespace poise {

/// { v : A v = 0 } of a matrix A that is computed with errors, from two evaluations of it.
///
/// The second evaluation has other errors of the same size: other rounding, or another step of integration. Both have
/// null spaces N, N' of the same dimension, found by the widest gap of the singular values, columns of A having unit
/// length. The rows of the projectors N N^T and N' N'^T differ by their errors, so that a number has no part in the
/// null space exactly if its row is as small as that difference. In doubt it has: what is said to be free of it is.
struct NullSpace {
  Eigen::MatrixXd basis;  ///< columns; rows of numbers that have no part in it are exactly zero
  Eigen::VectorXd error;  ///< of the rows of the basis
  double gap = 0.0;       ///< smallest singular value that is not zero over the largest that is; 0 without a null space
  bool unclear = false;   ///< some singular values may be zero or not, and count as zero

  Eigen::Index dimension() const { return basis.cols(); }
  bool touches(Eigen::Index number) const { return dimension() > 0 && (basis.row(number).array() != 0.0).any(); }
};

/// The part of the null space of `a` that is not in `known`, where `again` is the other evaluation of `a`.
NullSpace null_space(const Eigen::MatrixXd& a, const Eigen::MatrixXd& again, const NullSpace& known);

/// Whether a column of a matrix is no larger than its errors, `again` being the other evaluation of it.
bool is_rounding(const Eigen::VectorXd& column, const Eigen::VectorXd& again);

/// Orthonormal columns that span the complement of the columns of `basis`.
Eigen::MatrixXd complement(const Eigen::MatrixXd& basis);

}  // namespace poise
