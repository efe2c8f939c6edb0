#include "statics/all_equilibria/private/newton_operator.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "statics/all_equilibria/private/interval_matrix.hpp"

namespace poise {

namespace {

constexpr int most_refinements = 6;       // of z_0, by Newton's method
constexpr double near_the_middle = 0.75;  // of the box's width, by which z_0 may leave its middle
constexpr double always_further = 1e-8;   // rad or sizes, that the reach may grow to
constexpr double little_further = 16.0;   // times its size, to which it may grow
constexpr int most_inflations = 2;
constexpr int weight_steps = 4;  // of the power iteration that finds weights
constexpr int shrinking_sweeps = 3;

}  // namespace

NewtonOperator::NewtonOperator(const Mechanism<double>& plain, MergedMechanism& mechanism, const std::vector<int>& rows,
                               const std::vector<double>& bounds, const std::vector<int>& equation, int m)
    : plain_(plain),
      mechanism_(mechanism),
      rows_(rows),
      bounds_(bounds),
      equation_(equation),
      n_(plain.coordinates()),
      m_(m),
      is_square_(m_ == n_),
      size_(is_square_ ? n_ : n_ + m_),
      first_(is_square_ ? 0 : n_),
      f_(size_),
      reach_(n_),
      u_(size_),
      plain_pose_(plain.pose_size()),
      plain_jacobian_(plain.jacobian_row().size()),
      plain_tangent_(plain.tangent_row().size()),
      plain_constraint_(plain.constraints()),
      plain_multipliers_(plain.constraints(), 0.0),
      residual_(size_),
      matrix_(size_, size_),
      around_(n_),
      pose_(mechanism.pose_size()),
      jacobian_(plain_jacobian_.size()),
      constraint_(plain_constraint_.size()),
      tangent_(plain_tangent_.size()),
      multipliers_(plain_constraint_.size()),
      a_(static_cast<std::size_t>(size_) * size_),
      row_(size_),
      contraction_(a_.size()),
      first_step_(size_),
      weight_(size_),
      next_(size_) {}

bool NewtonOperator::begin(const std::vector<Interval>& box, const std::vector<double>& x,
                           const std::vector<double>& y) {
  x_ = x;
  y_ = y;
  exists_ = false;
  std::fill(plain_multipliers_.begin(), plain_multipliers_.end(), 0.0);
  refine(box);
  linearize();
  inverse_ = matrix_.partialPivLu().inverse();
  if (!inverse_.allFinite()) return false;
  for (int i = 0; i < n_; ++i) {
    const double half = std::max(box[i].upper() - x_[i], x_[i] - box[i].lower());
    reach_[i] = 1.1 * half + 1e-12;
  }
  evaluate_middle();
  return true;
}

// Takes Newton's steps while z_0 stays near the middle of the box; else it is the middle.
void NewtonOperator::refine(const std::vector<Interval>& box) {
  x_start_ = x_;
  y_start_ = y_;
  is_near_ = true;
  for (int step = 0; step < most_refinements && is_near_; ++step) {
    linearize();
    const Eigen::VectorXd z = -matrix_.partialPivLu().solve(residual_);
    if (!z.allFinite()) {
      is_near_ = false;
      break;
    }
    double most = 0.0;
    for (int i = 0; i < n_; ++i) {
      x_[i] += z[i];
      most = std::max(most, std::abs(z[i]));
      is_near_ = is_near_ && std::abs(x_[i] - x_start_[i]) <= near_the_middle * box[i].width() + always_further;
    }
    if (!is_square_) {
      for (int k = 0; k < m_; ++k) y_[k] += z[n_ + k];
    }
    if (most < 1e-14) break;
  }
  if (is_near_) return;
  x_ = x_start_;
  y_ = y_start_;
}

// Evaluates f and its matrix at z_0 in double.
void NewtonOperator::linearize() {
  plain_.place(x_.data(), plain_pose_.data());
  plain_.jacobian(plain_pose_.data(), plain_jacobian_.data());
  plain_.constraint(x_.data(), plain_pose_.data(), plain_constraint_.data());
  matrix_.setZero();
  residual_.setZero();
  if (!is_square_) {
    for (int k = 0; k < m_; ++k) plain_multipliers_[rows_[k]] = y_[k];
    plain_.negative_force(x_.data(), plain_pose_.data(), residual_.data());
    plain_.tangent(plain_pose_.data(), plain_multipliers_.data(), plain_tangent_.data());
    for (std::size_t e = 0; e < plain_tangent_.size(); ++e) {
      const int i = plain_.tangent_row()[e];
      const int j = plain_.tangent_column()[e];
      matrix_(i, j) += plain_tangent_[e];
      if (i != j && !plain_.has_follower_loads()) matrix_(j, i) += plain_tangent_[e];
    }
  }
  for (std::size_t e = 0; e < plain_jacobian_.size(); ++e) {
    const int k = equation_of(e);
    if (k < 0) continue;
    const int i = plain_.jacobian_column()[e];
    matrix_(first_ + k, i) += plain_jacobian_[e];
    if (is_square_) continue;
    matrix_(i, first_ + k) += plain_jacobian_[e];
    residual_[i] += plain_jacobian_[e] * y_[k];
  }
  for (int k = 0; k < m_; ++k) residual_[first_ + k] = plain_constraint_[rows_[k]] - bounds_[k];
}

// Encloses f(z_0).
void NewtonOperator::evaluate_middle() {
  std::fill(f_.begin(), f_.end(), Interval(0));
  for (int i = 0; i < n_; ++i) around_[i] = Interval(x_[i]);
  mechanism_.place(around_.data(), pose_.data());
  mechanism_.constraint(around_.data(), pose_.data(), constraint_.data());
  for (int k = 0; k < m_; ++k) f_[first_ + k] = constraint_[rows_[k]] - Interval(bounds_[k]);
  if (is_square_) return;
  mechanism_.negative_force(around_.data(), pose_.data(), f_.data());
  mechanism_.jacobian(pose_.data(), jacobian_.data());
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    const int k = equation_of(e);
    if (k >= 0) f_[plain_.jacobian_column()[e]] += jacobian_[e] * Interval(y_[k]);
  }
}

bool NewtonOperator::apply() {
  enclose_matrix();
  precondition();
  if (!bound_by_weights()) return false;
  shrink();
  return true;
}

// Encloses A over all within reach of the middle.
void NewtonOperator::enclose_matrix() {
  for (int i = 0; i < n_; ++i) around_[i] = Interval(x_[i]) + Interval(-reach_[i], reach_[i]);
  std::fill(a_.begin(), a_.end(), Interval(0));
  mechanism_.place(around_.data(), pose_.data());
  mechanism_.jacobian(pose_.data(), jacobian_.data());
  for (std::size_t e = 0; e < jacobian_.size(); ++e) {
    const int k = equation_of(e);
    if (k < 0) continue;
    const int i = plain_.jacobian_column()[e];
    entry(first_ + k, i) += jacobian_[e];
    if (!is_square_) entry(i, first_ + k) += jacobian_[e];
  }
  if (is_square_) return;
  std::fill(multipliers_.begin(), multipliers_.end(), Interval(0));
  for (int k = 0; k < m_; ++k) multipliers_[rows_[k]] = Interval(y_[k]);
  mechanism_.tangent(pose_.data(), multipliers_.data(), tangent_.data());
  for (std::size_t e = 0; e < tangent_.size(); ++e) {
    const int i = plain_.tangent_row()[e];
    const int j = plain_.tangent_column()[e];
    entry(i, j) += tangent_[e];
    if (i != j && !plain_.has_follower_loads()) entry(j, i) += tangent_[e];
  }
}

// Finds C and |R f|.
void NewtonOperator::precondition() {
  for (int i = 0; i < size_; ++i) {
    std::fill(row_.begin(), row_.end(), Interval(0));
    Interval step(0);
    for (int k = 0; k < size_; ++k) {
      const double factor = inverse_(i, k);
      if (factor == 0) continue;
      add_product(step, factor, f_[k]);
      for (int j = 0; j < size_; ++j) add_product(row_[j], factor, a_[static_cast<std::size_t>(k) * size_ + j]);
    }
    row_[i] -= Interval(1);
    first_step_[i] = step.magnitude();
    for (int j = 0; j < size_; ++j) contraction_[static_cast<std::size_t>(i) * size_ + j] = row_[j].magnitude();
  }
}

// Computes C v, `with_step` |R f| + C v, rounded up.
void NewtonOperator::contract(const std::vector<double>& v, bool with_step, std::vector<double>& out) const {
  for (int i = 0; i < size_; ++i) {
    double sum = with_step ? first_step_[i] : 0.0;
    for (int j = 0; j < size_; ++j) sum += contraction_[static_cast<std::size_t>(i) * size_ + j] * v[j];
    out[i] = sum;
  }
}

// Bounds u by a multiple of weights near the dominant direction of C. False if C w < w does not hold for these.
bool NewtonOperator::bound_by_weights() {
  std::fill(weight_.begin(), weight_.end(), 1.0);
  for (int step = 0; step < weight_steps; ++step) {
    contract(weight_, false, next_);
    double most = 0.0;
    for (const double v : next_) most = std::max(most, v);
    if (!(most > 0) || !std::isfinite(most)) break;
    for (int i = 0; i < size_; ++i) weight_[i] = next_[i] / most + 1e-3 * weight_[i] + 1e-12;
  }
  double norm = 0.0;
  double scale = 0.0;
  contract(weight_, false, next_);
  for (int i = 0; i < size_; ++i) {
    const double ratio = next_[i] / weight_[i];
    if (!(ratio < 1)) return false;
    norm = std::max(norm, ratio);
    scale = std::max(scale, first_step_[i] / weight_[i]);
  }
  const double bound = (Interval(scale) / (Interval(1) - Interval(norm))).upper();
  for (int i = 0; i < size_; ++i) u_[i] = bound * weight_[i];
  return true;
}

// Makes u smaller by u <- |R f| + C u, and tells whether it is within reach.
void NewtonOperator::shrink() {
  for (int sweep = 0; sweep < shrinking_sweeps; ++sweep) {
    bool within = true;
    for (int i = 0; i < n_; ++i) within = within && u_[i] < reach_[i];
    exists_ = within;
    contract(u_, true, next_);
    for (int i = 0; i < size_; ++i) u_[i] = std::min(u_[i], next_[i]);
  }
}

void NewtonOperator::reach_further() {
  for (int k = 0; k < most_inflations && !exists_ && is_near_; ++k) {
    bool is_little = true;
    for (int i = 0; i < n_; ++i) {
      is_little = is_little && u_[i] < std::max(little_further * reach_[i], always_further);
      reach_[i] = std::max(reach_[i], 2.0 * u_[i]);
    }
    if (!is_little || !apply()) return;
  }
}

}  // namespace poise
