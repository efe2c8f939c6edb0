#include "identification/identifiability/null_space.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// A difference of two evaluations shows the size of errors, to about this factor.
constexpr double gap_margin = 30.0;
/// Above this multiple of the difference an effect is certain.
constexpr double certain_ratio = 1e3;
/// Singular values below one that is larger by less than this are not known to be zero.
constexpr double wide_gap = 1e3;
/// Rows of the null space, of unit length, that are known worse than to this may have any part in it.
constexpr double resolved = 1e-6;
/// What is smaller, of columns of unit length, may come from numbers of a scene that should be zero and are rounding.
constexpr double least_effect = 1e-13;
/// Rounding of a decomposition.
constexpr double value_rounding = 10 * std::numeric_limits<double>::epsilon();

/// R of A = Q R, square.
Eigen::MatrixXd triangle(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd whole = Eigen::MatrixXd::Zero(std::max(a.rows(), a.cols()), a.cols());
  whole.topRows(a.rows()) = a;
  return solvers::triangular_factor(whole);
}

}  // namespace

bool is_rounding(const Eigen::VectorXd& column, const Eigen::VectorXd& again) {
  return column.norm() <= gap_margin * (again - column).norm();
}

Eigen::MatrixXd complement(const Eigen::MatrixXd& basis) {
  const Eigen::Index n = basis.rows();
  if (basis.cols() == 0) return Eigen::MatrixXd::Identity(n, n);
  // Directions count alike, however long they are.
  const Eigen::MatrixXd alike = basis * basis.colwise().norm().cwiseInverse().asDiagonal();
  return solvers::singular_value_decomposition(alike.transpose()).right.rightCols(n - basis.cols());
}

NullSpace null_space(const Eigen::MatrixXd& a, const Eigen::MatrixXd& again, const NullSpace& known) {
  const Eigen::Index n = a.cols();
  NullSpace out;
  out.basis.resize(n, 0);
  out.error = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd length = Eigen::VectorXd::Ones(n);
  Eigen::MatrixXd unit = a;
  Eigen::MatrixXd unit_again = again;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (is_rounding(a.col(i), again.col(i))) {
      out.doubtful = out.doubtful || !a.col(i).isZero(0.0);
      unit.col(i).setZero();
      unit_again.col(i).setZero();
      continue;
    }
    length[i] = a.col(i).norm();
    unit.col(i) /= length[i];
    unit_again.col(i) /= length[i];
  }
  // Coordinates: numbers times the lengths of their columns, orthogonal to what is known.
  const Eigen::MatrixXd rest =
      known.dimension() > 0 ? complement(length.asDiagonal() * known.basis) : complement(Eigen::MatrixXd(n, 0));
  if (rest.cols() == 0) return out;
  const solvers::SingularValues svd = solvers::singular_value_decomposition(triangle(unit * rest));
  const Eigen::VectorXd& s = svd.values;
  // To first order the error E of A changes  A v  of a right singular vector v by E v.
  const Eigen::VectorXd differences = ((unit_again - unit) * rest * svd.right).colwise().norm();
  const auto over_error = [&](Eigen::Index k) { return s[k] / std::max(differences[k], value_rounding); };
  Eigen::Index rank = 0;
  while (rank < s.size() && over_error(rank) > certain_ratio) ++rank;
  if (rank == s.size()) return out;
  for (Eigen::Index k = rank; k < s.size(); ++k) {
    out.doubtful = out.doubtful || std::max(s[k], differences[k]) > least_effect;
  }
  // Of these, those beyond a wide gap are zero.
  const auto drop = [&](Eigen::Index k) {
    return k == 0 ? std::numeric_limits<double>::infinity() : s[k - 1] / std::max(s[k], value_rounding);
  };
  Eigen::Index zero = rank;
  for (Eigen::Index k = rank + 1; k < s.size(); ++k) zero = drop(k) > drop(zero) ? k : zero;
  out.gap = drop(zero);
  out.unclear = static_cast<int>((out.gap < wide_gap ? s.size() : zero) - rank);
  const Eigen::MatrixXd nulls = rest * svd.right.rightCols(s.size() - rank);
  const solvers::SingularValues other = solvers::singular_value_decomposition(triangle(unit_again * rest));
  const Eigen::MatrixXd nulls_again = rest * other.right.rightCols(s.size() - rank);
  const Eigen::MatrixXd difference = nulls * nulls.transpose() - nulls_again * nulls_again.transpose();
  // To first order an error E of A moves the null space by  -V S^-1 U^T E N,  with the other singular values S.
  const Eigen::MatrixXd others = rest * svd.right.leftCols(rank) * s.head(rank).cwiseInverse().asDiagonal();
  out.basis = nulls;
  for (Eigen::Index i = 0; i < n; ++i) {
    out.error[i] =
        std::max(gap_margin * difference.row(i).norm(), value_rounding * std::max(1.0, others.row(i).norm()));
    const double part = nulls.row(i).norm();
    if (out.error[i] < resolved && part <= out.error[i])
      out.basis.row(i).setZero();
    else
      out.doubtful = out.doubtful || part <= certain_ratio / gap_margin * out.error[i];
  }
  out.basis = length.cwiseInverse().asDiagonal() * out.basis;
  out.error = length.cwiseInverse().asDiagonal() * out.error;
  return out;
}

}  // namespace poise
