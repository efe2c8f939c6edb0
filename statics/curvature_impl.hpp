#pragma once

#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "model/mechanism.hpp"

namespace poise {

/// Constraint values, Jacobian, force and tangent of a mechanism at q as dense matrices, for the few places that look
/// at an answer once rather than iterate.
template <class T>
struct DensePoint {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  DensePoint(const Mechanism<T>& given, const std::vector<T>& q, const std::vector<int>& rows)
      : mechanism(given), pose(given.pose_size()), kept(rows) {
    mechanism.place(q.data(), pose.data());
    force.resize(mechanism.coordinates());
    mechanism.negative_force(q.data(), pose.data(), force.data());
    constraint.resize(mechanism.constraints());
    mechanism.constraint(q.data(), pose.data(), constraint.data());
    std::vector<T> values(mechanism.jacobian_row().size());
    mechanism.jacobian(pose.data(), values.data());
    std::vector<int> place(mechanism.constraints(), -1);
    for (std::size_t k = 0; k < rows.size(); ++k) place[rows[k]] = static_cast<int>(k);
    jacobian = Matrix::Zero(static_cast<Eigen::Index>(rows.size()), mechanism.coordinates());
    for (std::size_t e = 0; e < values.size(); ++e) {
      const int row = place[mechanism.jacobian_row()[e]];
      if (row >= 0) jacobian(row, mechanism.jacobian_column()[e]) += values[e];
    }
  }

  /// Least-squares multipliers of the kept rows: minimal |F + J^T y|.
  Vector multipliers() const {
    if (kept.empty()) return Vector(0);
    return jacobian.transpose().completeOrthogonalDecomposition().solve(-force);
  }

  Matrix tangent(const Vector& y) {
    std::vector<T> all(mechanism.constraints(), T(0));
    for (std::size_t k = 0; k < kept.size(); ++k) all[kept[k]] = y[static_cast<Eigen::Index>(k)];
    std::vector<T> values(mechanism.tangent_row().size());
    mechanism.tangent(pose.data(), all.data(), values.data());
    Matrix out = Matrix::Zero(mechanism.coordinates(), mechanism.coordinates());
    for (std::size_t e = 0; e < values.size(); ++e) {
      const int i = mechanism.tangent_row()[e];
      const int j = mechanism.tangent_column()[e];
      out(i, j) += values[e];
      if (!mechanism.has_follower_loads() && i != j) out(j, i) += values[e];
    }
    return out;
  }

  const Mechanism<T>& mechanism;
  std::vector<Planar<T>> pose;
  std::vector<int> kept;
  Vector force;
  std::vector<T> constraint;
  Matrix jacobian;
};

/// Reduced Hessian  Z^T (tangent) Z  with Z an orthonormal basis of the null space of the kept rows of the Jacobian.
template <class T>
struct ReducedHessian {
  using Matrix = typename DensePoint<T>::Matrix;

  ReducedHessian(const Mechanism<T>& mechanism, const std::vector<T>& q, const std::vector<int>& rows) {
    DensePoint<T> point(mechanism, q, rows);
    const Matrix full = point.tangent(point.multipliers());
    const Eigen::Index n = mechanism.coordinates();
    Eigen::Index rank = 0;
    Matrix q_factor = Matrix::Identity(n, n);
    if (!rows.empty()) {
      const Eigen::ColPivHouseholderQR<Matrix> qr(point.jacobian.transpose());
      // Redundant constraints leave pivots that are nothing but rounding.
      Eigen::ColPivHouseholderQR<Matrix> ranked = qr;
      ranked.setThreshold(T(1e-10));
      rank = ranked.rank();
      q_factor = qr.householderQ() * Matrix::Identity(n, n);
    }
    basis = q_factor.rightCols(n - rank);
    matrix = basis.transpose() * full * basis;
    force = basis.transpose() * point.force;
    coupling = basis.transpose() * full;
    jacobian = point.jacobian;
    for (int r : rows) kept.push_back(point.constraint[r]);
    largest = full.size() > 0 ? T(full.cwiseAbs().maxCoeff()) : T(0);
  }

  Matrix basis;                          ///< n x freedoms
  Matrix coupling;                       ///< Z^T (tangent), freedoms x n
  Matrix jacobian;                       ///< of the kept rows
  std::vector<T> kept;                   ///< values of the kept rows; those of stops from zero, not from their bound
  typename DensePoint<T>::Vector force;  ///< Z^T F, what is left unbalanced
  Matrix matrix;                         ///< freedoms x freedoms, not symmetric with follower loads
  T largest;                             ///< largest entry of the tangent, the scale of `matrix`
};

}  // namespace poise
