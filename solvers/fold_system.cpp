#include "solvers/fold_system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra.hpp"

namespace poise::solvers {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int most_newton_steps = 10;
constexpr double undisturbed = 2e-5;   // distance in x: that of a fold by an imperfection of 3e-15
constexpr double least_motion = 1e-9;  // of x in v: with less, v is of multipliers of dependent rows

}  // namespace

FoldSystem::FoldSystem(CurveFamily& family)
    : family_(family), n_(family.first_varies(0.5).variables()), size_(family.first_varies(0.5).unknowns() - 1) {}

double FoldSystem::dot(const VectorXd& a, const VectorXd& b) const {
  return a.head(n_).dot(b.head(n_)) + a.tail(2).dot(b.tail(2));
}

double FoldSystem::norm(const VectorXd& a) const { return std::sqrt(dot(a, a)); }

VectorXd FoldSystem::first_part(const VectorXd& z) const { return z.head(size_ + 1); }

VectorXd FoldSystem::second_part(const VectorXd& z) const {
  VectorXd out = z.head(size_ + 1);
  out[size_] = z[size_ + 1];
  return out;
}

void FoldSystem::evaluate(const VectorXd& z) {
  MatrixXd other;
  VectorXd same;
  family_.second_varies(z[size_]).equations(second_part(z), same, other);
  by_q_ = other.col(size_).head(size_);
  family_.first_varies(z[size_ + 1]).equations(first_part(z), r_, a_);
}

void FoldSystem::border_by(const VectorXd& v, const VectorXd& w) {
  b_ = w / w.head(n_).norm();
  c_ = v / v.head(n_).norm();
  b_.tail(size_ - n_).setZero();
  c_.tail(size_ - n_).setZero();
}

// v, w, g, and the matrix of Newton's method at z. False if something is not finite.
bool FoldSystem::bordered(const VectorXd& z, const VectorXd& row) {
  evaluate(z);
  MatrixXd border(size_ + 1, size_ + 1);
  border.topLeftCorner(size_, size_) = a_.topLeftCorner(size_, size_);
  border.col(size_).head(size_) = b_;
  border.row(size_).head(size_) = c_.transpose();
  border(size_, size_) = 0.0;
  if (!border.allFinite() || !by_q_.allFinite()) return false;
  const VectorXd last = VectorXd::Unit(size_ + 1, size_);
  const VectorXd right = FullyPivotedLu(border).solve(last);
  const MatrixXd transposed = border.transpose();
  const VectorXd left = FullyPivotedLu(transposed).solve(last);
  v_ = right.head(size_);
  w_ = left.head(size_);
  g_ = right[size_];
  VectorXd direction(size_ + 1);
  direction << v_, 0.0;
  along_.resize(size_, size_ + 2);
  along_.col(size_ + 1) = family_.second_varies(z[size_]).second(second_part(z), direction).col(size_).head(size_);
  along_.leftCols(size_ + 1) = family_.first_varies(z[size_ + 1]).second(first_part(z), direction).topRows(size_);
  newton_.resize(size_ + 2, size_ + 2);
  newton_.topLeftCorner(size_, size_ + 1) = a_.topRows(size_);
  newton_.col(size_ + 1).head(size_) = by_q_;
  newton_.row(size_) = -(w_.transpose() * along_);
  newton_.row(size_ + 1) = row.transpose();
  return newton_.allFinite();
}

FoldSystem::Correction FoldSystem::correct(FoldPlace& place, const VectorXd& row_like, const FoldPlace& near) {
  Correction out;
  VectorXd row = row_like;
  row.segment(n_, size_ - n_).setZero();
  border_by(near.v, near.w);
  double before = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most_newton_steps; ++k) {
    if (!bordered(place.z, row)) return out;
    VectorXd rhs(size_ + 2);
    rhs << -r_, -g_, 0.0;
    const FullyPivotedLu lu(newton_);
    const VectorXd step = lu.solve(rhs);
    const double length = norm(step);
    if (k == 0) out.first = length;
    if (!(length < Curve::farthest)) return out;
    place.z += step;
    if (length <= Curve::small_step || length > 0.5 * before) {
      out.converged = length <= Curve::rounding_step;
      if (!out.converged) return out;
      place.tangent = lu.solve(VectorXd(VectorXd::Unit(size_ + 2, size_ + 1)));
      place.tangent /= norm(place.tangent);
      const double motion_v = v_.head(n_).norm(), motion_w = w_.head(n_).norm();
      place.coefficient = w_.dot(along_.leftCols(size_) * v_) / (motion_w * motion_v * motion_v);
      place.v = v_ / motion_v;
      place.w = w_ / motion_w;
      out.converged = place.tangent.allFinite() && motion_v > least_motion * v_.norm() && motion_w > 0.0;
      return out;
    }
    before = length;
  }
  return out;
}

FoldSystem::Begin FoldSystem::begin(FoldPlace& place) {
  Begin out;
  evaluate(place.z);
  if (!a_.allFinite()) return out;
  const SingularValues svd = singular_value_decomposition(a_.topLeftCorner(size_, size_));
  FoldPlace near;
  near.v = svd.right.col(size_ - 1);
  near.w = svd.left.col(size_ - 1);
  // Left and right vectors of a symmetric matrix in the same sense.
  if (near.v.dot(near.w) < 0.0) near.w = -near.w;
  if (!(std::min(near.v.head(n_).norm(), near.w.head(n_).norm()) > least_motion)) return out;
  border_by(near.v, near.w);
  if (!bordered(place.z, VectorXd::Zero(size_ + 2))) return out;
  const double motion = v_.head(n_).norm();
  const VectorXd forces = w_.transpose() * newton_.topRightCorner(size_, 2);
  const VectorXd changes = w_.transpose() * along_.rightCols(2) / motion;
  out.undisturbed = (forces.array().abs() <= undisturbed * changes.array().abs()).all();
  if (out.undisturbed) return out;
  const VectorXd row = singular_value_decomposition(newton_.topRows(size_ + 1)).right.col(size_ + 1);
  const VectorXd from = place.z;
  out.converged = correct(place, row, near).converged;
  out.distance = norm(place.z - from);
  return out;
}

FoldSystem::Sensitivity FoldSystem::sensitivity(const FoldPlace& cusp) {
  border_by(cusp.v, cusp.w);
  VectorXd row = cusp.tangent;
  row.segment(n_, size_ - n_).setZero();
  if (!bordered(cusp.z, row)) return {VectorXd::Zero(size_ + 1), VectorXd::Zero(size_ + 1)};
  newton_.row(size_) = cusp.w.transpose() * along_ / v_.head(n_).norm();
  const MatrixXd transposed = newton_.transpose();
  const FullyPivotedLu lu(transposed);
  const auto row_of = [&](int unknown) -> VectorXd {
    return lu.solve(VectorXd(VectorXd::Unit(size_ + 2, unknown))).head(size_ + 1);
  };
  return {row_of(size_), row_of(size_ + 1)};
}

double FoldSystem::residual(const VectorXd& z) {
  evaluate(z);
  return r_.cwiseAbs().maxCoeff();
}

int FoldSystem::other_negative_directions(const VectorXd& z, bool symmetric) {
  evaluate(z);
  if (!symmetric) return -1;
  // R_u has one positive and one negative eigenvalue for each active row besides those of the reduced matrix.
  const VectorXd values = symmetric_eigenvalues<double>(a_.topLeftCorner(size_, size_));
  Index critical = 0;
  values.cwiseAbs().minCoeff(&critical);
  const int negative = static_cast<int>((values.array() < 0.0).count()) - (values[critical] < 0.0 ? 1 : 0);
  return negative - (size_ - n_);
}

}  // namespace poise::solvers
