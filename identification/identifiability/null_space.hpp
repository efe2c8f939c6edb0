#pragma once

#include <Eigen/Core>

namespace poise {

/// { v : A v = 0 } of a matrix A that is computed with errors, from two evaluations of it.
///
/// The second evaluation has other errors of the same size: other rounding, or another step of integration. Both have
/// singular values s_k with right vectors v_k, columns of A having unit length: of what v_k changes, A v_k with the
/// length s_k, (A' - A) v_k is error, and s_k counts as zero unless it is far larger than that. The rows of the
/// projectors N N^T and N' N'^T of the null spaces differ by their errors, so that a number has no part in the null
/// space exactly if its row is as small as that difference, and the difference is small. In doubt it has: what is said
/// to be free of it is.
struct NullSpace {
  Eigen::MatrixXd basis;  ///< columns; rows of numbers that have no part in it are exactly zero
  Eigen::VectorXd error;  ///< of the rows of the basis
  double gap = 0.0;       ///< widest ratio of successive singular values from the last that is not zero on; 0 without
  int unclear = 0;        ///< directions of these before that gap, or all of them where it is narrow: in doubt null
  bool doubtful = false;  ///< more digits may show that it, or a part of a number in it, is only an effect too small

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
