#include "solvers/regular_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>
#include <Eigen/LU>

namespace poise::solvers {
namespace {

constexpr double unit = std::numeric_limits<double>::epsilon() / 2;  // u: |fl(x) - x| <= u |x|
// Twice a + b, a b, or a sum of products of non-negative doubles computed in any order with less than 1e6 terms is more
// than its exact value enlarged by rounding: factor by which such results are raised to be bounds.
constexpr double upward = 1.0 + 1e-9;
constexpr double infinity = std::numeric_limits<double>::infinity();

// gamma_n = n u / (1 - n u), the relative rounding error of a sum of n products (Higham, "Accuracy and Stability of
// Numerical Algorithms", 2nd ed., eq. 3.5), raised.
double gamma(Eigen::Index n) { return upward * (static_cast<double>(n) + 1.0) * unit; }

}  // namespace

RegularSet::RegularSet(int size, bool symmetric, const std::vector<Entry>& entries)
    : size_(size), symmetric_(symmetric), center_(size, symmetric, centers(entries)), kappa_(infinity) {
  if (!center_.regular()) return;
  if (size <= dense_limit)
    bound_by_inverse(entries);
  else
    bound_by_shifts(entries);
}

std::vector<RegularSet::Entry> RegularSet::centers(const std::vector<Entry>& entries) {
  std::vector<Entry> out;
  out.reserve(entries.size());
  for (const Entry& e : entries) out.push_back({e.row, e.column, e.value.midpoint()});
  return out;
}

void RegularSet::bound_by_inverse(const std::vector<Entry>& entries) {
  const Eigen::Index n = size_;
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXd r = Eigen::MatrixXd::Zero(n, n);   // of the set
  Eigen::MatrixXd ra = Eigen::MatrixXd::Zero(n, n);  // of the conversion of A_c to doubles
  const auto add = [&](int i, int j, double value, double radius) {
    // One rounding for the conversion, one for the sum of entries of one place.
    a(i, j) += value;
    ra(i, j) += 2 * unit * (std::abs(value) + std::abs(a(i, j)));
    r(i, j) += radius;
  };
  for (const Entry& e : entries) {
    const double value = e.value.middle();
    const double radius = e.value.radius();
    if (!std::isfinite(value) || !std::isfinite(radius)) return;
    add(e.row, e.column, value, radius);
    if (symmetric_ && e.row != e.column) add(e.column, e.row, value, radius);
  }
  const Eigen::MatrixXd c = a.partialPivLu().inverse();
  if (!c.allFinite()) return;
  const Eigen::MatrixXd size_of_c = c.cwiseAbs();
  Eigen::MatrixXd left = c * a;
  left.diagonal().array() -= 1.0;
  // Rounding of C A, of the subtraction, and of A itself; and underflow.
  const Eigen::MatrixXd rounding = size_of_c * (gamma(n + 2) * a.cwiseAbs() + ra);
  const double tiny = static_cast<double>(n) * std::numeric_limits<double>::min();
  weight_.assign(size_, 1.0);
  inverse_.assign(size_of_c.data(), size_of_c.data() + n * n);
  Eigen::VectorXd w = Eigen::VectorXd::Ones(n);
  for (int pass = 0; pass < 3; ++pass) {
    const Eigen::VectorXd e_w = (left.cwiseAbs() * (1 + 4 * unit) + rounding) * w;
    const Eigen::VectorXd r_w = size_of_c * (r * w);
    double of_center = 0.0;
    double of_set = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) {
      of_center = std::max(of_center, upward * (e_w[i] + tiny) / w[i]);
      of_set = std::max(of_set, upward * (r_w[i] + tiny) / w[i]);
    }
    const double kappa = of_center < 0.5 ? upward * of_set / (1.0 - of_center) : infinity;
    if (kappa < kappa_) {
      kappa_ = kappa;
      of_center_ = of_center;
      for (Eigen::Index i = 0; i < n; ++i) weight_[i] = w[i];
    }
    if (kappa < 1e-3 || !r_w.allFinite() || r_w.maxCoeff() <= 0.0) return;
    // Weights near the Perron vector of |C| R, or of what the center leaves, give the least bound.
    w = (of_center < 0.5 ? r_w : e_w);
    w = w / w.maxCoeff();
    w = w.cwiseMax(1e-6);
  }
}

void RegularSet::bound_by_shifts(const std::vector<Entry>& entries) {
  std::vector<double> row_sum(size_, 0.0);
  std::vector<double> column_sum(size_, 0.0);
  for (const Entry& e : entries) {
    const double radius = e.value.radius();
    if (!std::isfinite(radius)) return;
    row_sum[e.row] += radius;
    column_sum[e.column] += radius;
    if (!symmetric_ || e.row == e.column) continue;
    row_sum[e.column] += radius;
    column_sum[e.row] += radius;
  }
  const double rows = *std::max_element(row_sum.begin(), row_sum.end());
  const double columns = *std::max_element(column_sum.begin(), column_sum.end());
  const double norm = upward * std::sqrt(rows * columns);  // |R|_2 <= sqrt(|R|_1 |R|_inf)
  least_ = least_singular_value(entries);
  if (least_ > 0.0) kappa_ = upward * norm / least_;
}

// Estimated by inverse iteration, then proved with a margin.
double RegularSet::least_singular_value(const std::vector<Entry>& entries) const {
  std::vector<Ball> x(size_);
  for (int i = 0; i < size_; ++i) x[i] = Ball(i % 3 == 0 ? 1.0 : i % 3 == 1 ? -0.7 : 0.3);
  double estimate = 0.0;
  for (int pass = 0; pass < 4; ++pass) {
    double length = 0.0;
    for (const Ball& v : x) length = std::hypot(length, v.middle());
    if (!(length > 0.0) || !std::isfinite(length)) return 0.0;
    for (Ball& v : x) v = Ball(v.middle() / length);
    x = solve_center(std::move(x));
    double grown = 0.0;
    for (const Ball& v : x) grown = std::hypot(grown, v.middle());
    estimate = 1.0 / grown;
  }
  const int whole = symmetric_ ? size_ : 2 * size_;
  std::vector<Entry> shifted;
  for (const Entry& e : entries) {
    if (symmetric_)
      shifted.push_back({e.row, e.column, e.value.midpoint()});
    else
      shifted.push_back({size_ + e.row, e.column, e.value.midpoint()});
  }
  const std::size_t fixed = shifted.size();
  for (double s = estimate / 2; s > estimate / 1000; s /= 4) {
    int negative[2] = {-1, -2};
    bool regular = true;
    for (const int side : {0, 1}) {
      shifted.resize(fixed);
      for (int i = 0; i < whole; ++i) shifted.push_back({i, i, Ball(side == 0 ? -s : s)});
      const BallFactors factors(whole, true, shifted);
      regular = regular && factors.regular();
      negative[side] = factors.negative();
    }
    if (regular && negative[0] == negative[1]) return s;
  }
  return 0.0;
}

std::vector<Ball> RegularSet::solve_center(std::vector<Ball> b) const {
  center_.solve(b);
  return b;
}

// x += A_c^-1 b for all |b| <= radius.
void RegularSet::add_effect(const std::vector<double>& radius, std::vector<Ball>& x) const {
  if (weight_.empty()) {
    double norm = 0.0;
    for (const double r : radius) norm = std::hypot(norm, r);
    for (Ball& v : x) v = v.widened(upward * norm / least_);
    return;
  }
  const Eigen::Index n = size_;
  const Eigen::VectorXd moved =
      Eigen::MatrixXd::Map(inverse_.data(), n, n) * Eigen::VectorXd::Map(radius.data(), n) * upward;
  double norm = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) norm = std::max(norm, moved[i] / weight_[i]);
  const double rest = upward * norm * of_center_ / (1.0 - of_center_);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = x[i].widened(upward * (moved[i] + rest * weight_[i]));
}

std::vector<Ball> RegularSet::solve(std::vector<Ball> b) const {
  std::vector<double> radius(size_);
  bool exact = true;
  for (int i = 0; i < size_; ++i) {
    radius[i] = b[i].radius();
    b[i] = b[i].midpoint();
    exact = exact && radius[i] == 0.0;
  }
  center_.solve(b);
  if (!exact) add_effect(radius, b);
  double norm = 0.0;
  for (int i = 0; i < size_; ++i) {
    const double size = b[i].greatest();
    norm = weight_.empty() ? std::hypot(norm, size) : std::max(norm, size / weight_[i]);
  }
  norm *= upward;
  const double part = upward * kappa_ / (1.0 - kappa_);
  for (int i = 0; i < size_; ++i) b[i] = b[i].widened(upward * part * norm * (weight_.empty() ? 1.0 : weight_[i]));
  return b;
}

}  // namespace poise::solvers
