#pragma once

// Dense linear algebra outside the iterations: ranks, null spaces, least squares, spectra. Templates exist for T =
// double and for T = Real50 (solvers/real50.hpp). Eigen's decompositions are compiled in solvers/linear_algebra*.cpp,
// so that others include Eigen/Core at most.
//
// Rank policy. Householder QR with column pivoting, A P = Q R, has |R_11| >= |R_22| >= ...; the rank is the number of
// pivots with
//
//   |R_kk| > max(tolerance, eps_T min(rows, columns)) |R_11|
//
// and everything that depends on a rank uses it. Rows and columns of A should be of comparable size, as those of scaled
// problems are. The tolerance is the relative accuracy of A, with a name for each case:

#include <memory>
#include <vector>

#include <Eigen/Core>

namespace poise::solvers {

/// Accuracy of a matrix relative to its largest pivot.
namespace known_to {
inline constexpr double rounding = 0.0;  ///< its entries are exact: only rounding of the decomposition counts
inline constexpr double half_of_50_digits = 1e-20;  ///< Newton in 50 digits, near roots where pivots vanish
inline constexpr double data = 1e-12;               ///< data rounded to double, computed with in 50 digits
inline constexpr double solution = 1e-10;           ///< at a point that Newton has converged to
inline constexpr double closed_point = 1e-9;        ///< at a point where the constraints hold to about that
inline constexpr double path = 1e-7;                ///< at points of a path, which may pass close to singular ones
inline constexpr double singular_point = 1e-4;      ///< where a search stopped on its way to a singular point
}  // namespace known_to

template <class T>
using DenseMatrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
template <class T>
using DenseVector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

/// The columns of A in pivot order: the first `rank` are independent, and within the tolerance each of the others is a
/// linear combination of them.
struct PivotOrder {
  Eigen::Index rank = 0;
  std::vector<int> columns;
};
template <class T>
PivotOrder pivot_order(const DenseMatrix<T>& a, double tolerance);

/// Rank of A.
template <class T>
Eigen::Index rank(const DenseMatrix<T>& a, double tolerance) {
  return pivot_order<T>(a, tolerance).rank;
}

/// Orthonormal basis Z of { x : A x = 0 }, columns - rank columns, by pivoting the rows of A.
template <class T>
DenseMatrix<T> null_space(const DenseMatrix<T>& a, double tolerance);

/// x = A^+ b: of all x with least |A x - b| the one of minimum norm, by complete orthogonal decomposition
/// A P = Q [R 0; 0 0] Z.
template <class T>
class LeastSquares {
 public:
  explicit LeastSquares(const DenseMatrix<T>& a, double tolerance = known_to::rounding);
  ~LeastSquares();

  DenseVector<T> solve(const DenseVector<T>& b) const;
  Eigen::Index rank() const;
  /// Orthonormal basis of { x : A x = 0 } from the same factors.
  DenseMatrix<T> null_space() const;

 private:
  struct Factors;
  std::unique_ptr<const Factors> factors_;
};

/// A^+ b for one right-hand side.
template <class T>
DenseVector<T> minimum_norm_solution(const DenseMatrix<T>& a, const DenseVector<T>& b,
                                     double tolerance = known_to::rounding) {
  return LeastSquares<T>(a, tolerance).solve(b);
}

/// Eigenvalues of a symmetric matrix, ascending. Only its lower triangle is read.
template <class T>
DenseVector<T> symmetric_eigenvalues(const DenseMatrix<T>& a);

// In double only.

/// A v_k = value_k v_k of a symmetric matrix, values ascending, the vectors v_k orthonormal columns. Only the lower
/// triangle of A is read.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& a);

/// A v_k = value_k v_k of a square matrix, vectors of unit length, in no particular order.
struct Eigenpairs {
  Eigen::VectorXcd values;
  Eigen::MatrixXcd vectors;
};
Eigenpairs eigenpairs(const Eigen::MatrixXd& a);

/// A = U diag(values) V^T, values descending, min(rows, columns) of them; U as many columns, V square. By Jacobi
/// rotations, which find small singular values to high relative accuracy.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd left, right;

  /// Number of singular values that are at least `tolerance` times the largest.
  Eigen::Index rank(double tolerance) const;
};
SingularValues singular_value_decomposition(const Eigen::MatrixXd& a);

/// The values alone, by divide and conquer: for matrices of hundreds of rows.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& a);

/// R of  A = Q R,  upper triangular and square, of a matrix of at least as many rows as columns, which is overwritten.
Eigen::MatrixXd triangular_factor(Eigen::MatrixXd& a);

/// Orthonormal columns that span those of A, as many as its rank.
Eigen::MatrixXd orthonormal_columns(const Eigen::MatrixXd& a);

/// Dependent columns as combinations of independent ones, for a matrix A of known rank r:
///   A.col(columns[r + k]) = sum_{i < r} share(i, k) A.col(columns[i])
struct ColumnShares {
  std::vector<int> columns;  ///< of A, in pivot order
  Eigen::MatrixXd share;     ///< r x (columns of A - r)
};
ColumnShares column_shares(const Eigen::MatrixXd& a, Eigen::Index rank);

/// P A Q = L U of a square matrix with full pivoting.
class FullyPivotedLu {
 public:
  explicit FullyPivotedLu(const Eigen::MatrixXd& a);
  ~FullyPivotedLu();

  /// x of A x = b; for a singular A, pivots that are rounding only count as zero.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd solve(const Eigen::MatrixXd& b) const;
  double largest_pivot() const;
  /// Estimate of 1 / (|A| |A^-1|), 1-norms; 0 if a pivot is rounding only.
  double reciprocal_condition() const;
  double determinant() const;
  /// 1, -1, or 0 where a pivot is zero; also where the determinant itself over- or underflows.
  int determinant_sign() const;

 private:
  struct Factors;
  std::unique_ptr<const Factors> factors_;
};

}  // namespace poise::solvers
