#pragma once

// Definitions of the templates of solvers/linear_algebra.hpp, for its sources only.

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "solvers/linear_algebra.hpp"

namespace poise::solvers {

/// The rank policy's limit for pivots relative to the largest.
template <class T>
T pivot_limit(const DenseMatrix<T>& a, double tolerance) {
  const T rounding = Eigen::NumTraits<T>::epsilon() * static_cast<T>(std::min(a.rows(), a.cols()));
  return std::max(static_cast<T>(tolerance), rounding);
}

/// A P = Q R.
template <class T>
Eigen::ColPivHouseholderQR<DenseMatrix<T>> pivoted_qr(const DenseMatrix<T>& a, double tolerance) {
  Eigen::ColPivHouseholderQR<DenseMatrix<T>> qr(a.rows(), a.cols());
  qr.setThreshold(pivot_limit(a, tolerance));
  qr.compute(a);
  return qr;
}

template <class T>
std::vector<int> pivoted_columns(const Eigen::ColPivHouseholderQR<DenseMatrix<T>>& qr) {
  const auto& indices = qr.colsPermutation().indices();
  return {indices.data(), indices.data() + indices.size()};
}

template <class T>
PivotOrder pivot_order(const DenseMatrix<T>& a, double tolerance) {
  if (a.size() == 0) {
    PivotOrder none;
    for (Eigen::Index c = 0; c < a.cols(); ++c) none.columns.push_back(static_cast<int>(c));
    return none;
  }
  const auto qr = pivoted_qr(a, tolerance);
  return {qr.rank(), pivoted_columns<T>(qr)};
}

template <class T>
DenseMatrix<T> null_space(const DenseMatrix<T>& a, double tolerance) {
  const Eigen::Index n = a.cols();
  if (a.size() == 0) return DenseMatrix<T>::Identity(n, n);
  const auto qr = pivoted_qr<T>(a.transpose(), tolerance);
  const DenseMatrix<T> q = qr.householderQ() * DenseMatrix<T>::Identity(n, n);
  return q.rightCols(n - qr.rank());
}

template <class T>
struct LeastSquares<T>::Factors {
  Eigen::CompleteOrthogonalDecomposition<DenseMatrix<T>> decomposition;
};

template <class T>
LeastSquares<T>::LeastSquares(const DenseMatrix<T>& a, double tolerance) {
  if (a.cols() == 0) return;  // nothing to factor; Eigen would read a pivot that does not exist
  auto factors = std::make_unique<Factors>();
  factors->decomposition.setThreshold(pivot_limit(a, tolerance));
  factors->decomposition.compute(a);
  factors_ = std::move(factors);
}

template <class T>
LeastSquares<T>::~LeastSquares() = default;

template <class T>
DenseVector<T> LeastSquares<T>::solve(const DenseVector<T>& b) const {
  if (!factors_) return {};
  return factors_->decomposition.solve(b);
}

template <class T>
Eigen::Index LeastSquares<T>::rank() const {
  return factors_ ? factors_->decomposition.rank() : 0;
}

template <class T>
DenseMatrix<T> LeastSquares<T>::null_space() const {
  if (!factors_) return {};
  const auto& of = factors_->decomposition;
  const DenseMatrix<T> z = of.matrixZ().transpose().rightCols(of.cols() - of.rank());
  return of.colsPermutation() * z;
}

template <class T>
DenseVector<T> symmetric_eigenvalues(const DenseMatrix<T>& a) {
  return Eigen::SelfAdjointEigenSolver<DenseMatrix<T>>(a, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace poise::solvers
