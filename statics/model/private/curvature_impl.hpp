#pragma once

#include "solvers/linear_algebra.hpp"
#include "statics/model/curvature.hpp"

namespace poise {

template <class T>
DensePoint<T>::DensePoint(const Mechanism<T>& given, const std::vector<T>& q, const std::vector<int>& rows)
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

template <class T>
typename DensePoint<T>::Vector DensePoint<T>::multipliers() const {
  if (kept.empty()) return Vector(0);
  return solvers::minimum_norm_solution<T>(jacobian.transpose(), -force);
}

template <class T>
typename DensePoint<T>::Matrix DensePoint<T>::tangent(const Vector& y) {
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

template <class T>
typename DensePoint<T>::Matrix DensePoint<T>::equations(const Vector& y) {
  const Eigen::Index n = force.size(), k = y.size();
  Matrix out = Matrix::Zero(n + k, n + k);
  out.topLeftCorner(n, n) = tangent(y);
  out.topRightCorner(n, k) = jacobian.transpose();
  out.bottomLeftCorner(k, n) = jacobian;
  return out;
}

}  // namespace poise
