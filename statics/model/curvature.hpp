#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/mechanism.hpp"

namespace poise {

/// Constraint values, Jacobian, force and tangent of a mechanism at q as dense matrices, for evaluation outside the
/// iterations. Definitions are in statics/model/private/curvature_impl.hpp; double is instantiated in
/// statics/model/curvature.cpp, 50 digits in statics/model/reference.cpp.
template <class T>
struct DensePoint {
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  DensePoint(const Mechanism<T>& given, const std::vector<T>& q, const std::vector<int>& rows);

  /// Least-squares multipliers of the kept rows: minimal |F + J^T y|.
  Vector multipliers() const;
  Matrix tangent(const Vector& y);
  /// The derivative by (q, y) of the equations  F + J^T y = 0,  c = 0  of the kept rows: (tangent, J^T; J, 0).
  Matrix equations(const Vector& y);

  const Mechanism<T>& mechanism;
  std::vector<Planar<T>> pose;
  std::vector<int> kept;
  Vector force;
  std::vector<T> constraint;
  Matrix jacobian;
};

/// Reduced Hessian  Z^T (tangent) Z  with Z an orthonormal basis of the null space of the kept rows of the Jacobian.
struct ReducedHessian {
  ReducedHessian(const Mechanism<double>& mechanism, const std::vector<double>& q, const std::vector<int>& rows);

  Eigen::MatrixXd basis;   ///< n x degrees of freedom
  Eigen::MatrixXd matrix;  ///< square, not symmetric with follower loads
  double largest;          ///< largest entry of the tangent, the scale of `matrix`
};

extern template struct DensePoint<double>;

}  // namespace poise
