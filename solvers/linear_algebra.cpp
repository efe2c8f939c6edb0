#include <utility>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "solvers/linear_algebra_impl.hpp"

namespace poise::solvers {

using Eigen::MatrixXd;
using Eigen::VectorXd;

template PivotOrder pivot_order(const MatrixXd&, double);
template MatrixXd null_space(const MatrixXd&, double);
template class LeastSquares<double>;
template VectorXd symmetric_eigenvalues(const MatrixXd&);

MatrixXd triangular_factor(MatrixXd& a) {
  const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(a);
  return a.topRows(a.cols()).triangularView<Eigen::Upper>();
}

MatrixXd orthonormal_columns(const MatrixXd& a) {
  const auto qr = pivoted_qr(a, known_to::rounding);
  return qr.householderQ() * MatrixXd::Identity(a.rows(), qr.rank());
}

ColumnShares column_shares(const MatrixXd& a, Eigen::Index rank) {
  const auto qr = pivoted_qr(a, known_to::rounding);
  const MatrixXd r = qr.matrixR().topRows(rank).triangularView<Eigen::Upper>();
  return {pivoted_columns<double>(qr),
          r.leftCols(rank).triangularView<Eigen::Upper>().solve(r.rightCols(a.cols() - rank))};
}

struct FullyPivotedLu::Factors {
  Eigen::FullPivLU<MatrixXd> lu;
};

FullyPivotedLu::FullyPivotedLu(const MatrixXd& a)
    : factors_(std::make_unique<const Factors>(Factors{Eigen::FullPivLU<MatrixXd>(a)})) {}

FullyPivotedLu::~FullyPivotedLu() = default;

VectorXd FullyPivotedLu::solve(const VectorXd& b) const { return factors_->lu.solve(b); }

MatrixXd FullyPivotedLu::solve(const MatrixXd& b) const { return factors_->lu.solve(b); }

double FullyPivotedLu::largest_pivot() const { return factors_->lu.maxPivot(); }

double FullyPivotedLu::reciprocal_condition() const { return factors_->lu.isInvertible() ? factors_->lu.rcond() : 0.0; }

double FullyPivotedLu::determinant() const { return factors_->lu.determinant(); }

int FullyPivotedLu::determinant_sign() const {
  const auto& lu = factors_->lu;
  auto sign = static_cast<int>(lu.permutationP().determinant() * lu.permutationQ().determinant());
  for (Eigen::Index i = 0; i < lu.matrixLU().rows(); ++i) {
    const double pivot = lu.matrixLU()(i, i);
    sign *= (pivot > 0.0 ? 1 : 0) - (pivot < 0.0 ? 1 : 0);
  }
  return sign;
}

SymmetricEigen symmetric_eigen(const MatrixXd& a) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigenpairs eigenpairs(const MatrixXd& a) {
  const Eigen::EigenSolver<MatrixXd> eigen(a);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Eigen::Index SingularValues::rank(double tolerance) const {
  return values.size() > 0 ? (values.array() >= tolerance * values[0] && values.array() > 0.0).count() : 0;
}

SingularValues singular_value_decomposition(const MatrixXd& a) {
  // Eigen reads an entry of a matrix that has none.
  if (a.size() == 0) return {VectorXd(0), MatrixXd(a.rows(), 0), MatrixXd::Identity(a.cols(), a.cols())};
  const Eigen::JacobiSVD<MatrixXd> svd(a, Eigen::ComputeThinU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

VectorXd singular_values(const MatrixXd& a) {
  return a.size() == 0 ? VectorXd(0) : VectorXd(Eigen::JacobiSVD<MatrixXd>(a).singularValues());
}

}  // namespace poise::solvers
