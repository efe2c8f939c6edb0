#include "solvers/bounded_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Cholesky>

namespace poise::solvers {
namespace {

constexpr double most_damping = 1e12, least_damping = 1e-14;
constexpr double fall = 0.2, growth = 5.0;   // of the damping
constexpr double smallest_diagonal = 1e-10;  // parts of the largest entry of the diagonal of J^T J
constexpr int weak_steps = 3;
constexpr int most_without_value = 6;  // steps in turn

/// The damped step of the variables that may move; zero of all others.
Eigen::VectorXd damped_step(const Eigen::MatrixXd& normal, const Eigen::VectorXd& gradient,
                            const std::vector<int>& free, double damping) {
  const auto n = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd a(n, n);
  Eigen::VectorXd b(n);
  const double least = smallest_diagonal * std::max(normal.diagonal().maxCoeff(), std::numeric_limits<double>::min());
  for (Eigen::Index i = 0; i < n; ++i) {
    const int row = free[static_cast<std::size_t>(i)];
    b[i] = -gradient[row];
    for (Eigen::Index j = 0; j < n; ++j) a(i, j) = normal(row, free[static_cast<std::size_t>(j)]);
    a(i, i) += damping * std::max(a(i, i), least) + least * damping;
  }
  const Eigen::VectorXd solved = a.ldlt().solve(b);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(gradient.size());
  for (Eigen::Index i = 0; i < n; ++i) out[free[static_cast<std::size_t>(i)]] = solved[i];
  return out;
}

/// Variables that a bound does not stop on the way downhill.
std::vector<int> free_variables(const Eigen::VectorXd& x, const Eigen::VectorXd& gradient, const Eigen::VectorXd& lower,
                                const Eigen::VectorXd& upper) {
  std::vector<int> out;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const bool is_held = (x[i] <= lower[i] && gradient[i] > 0.0) || (x[i] >= upper[i] && gradient[i] < 0.0);
    if (!is_held && lower[i] < upper[i]) out.push_back(static_cast<int>(i));
  }
  return out;
}

}  // namespace

BoundedLeastSquaresResult bounded_least_squares(const ResidualFunction& residuals, const Eigen::VectorXd& x,
                                                const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                                                const BoundedLeastSquaresOptions& options) {
  BoundedLeastSquaresResult out;
  out.x = x.cwiseMax(lower).cwiseMin(upper);
  out.sum = std::numeric_limits<double>::infinity();
  ResidualsAt at, there;
  if (!residuals(out.x, true, at)) return out;
  out.sum = at.value.squaredNorm();
  double damping = options.first_damping;
  int weak = 0;
  while (out.sum > options.good_enough && out.iterations < options.iterations && weak < weak_steps) {
    if (options.interrupt != nullptr && options.interrupt->load()) break;
    const Eigen::VectorXd gradient = at.by.transpose() * at.value;
    const std::vector<int> free = free_variables(out.x, gradient, lower, upper);
    if (free.empty()) break;
    const Eigen::MatrixXd normal = at.by.transpose() * at.by;
    bool is_lower = false;
    int without_value = 0;
    while (!is_lower && damping <= most_damping && out.iterations < options.iterations) {
      if (options.interrupt != nullptr && options.interrupt->load()) break;
      ++out.iterations;
      const Eigen::VectorXd step = damped_step(normal, gradient, free, damping);
      const Eigen::VectorXd next = (out.x + step).cwiseMax(lower).cwiseMin(upper);
      if (!next.allFinite() || next == out.x) break;
      const bool has_value = residuals(next, true, there);
      const double sum = has_value ? there.value.squaredNorm() : std::numeric_limits<double>::infinity();
      is_lower = sum < out.sum;
      if (!is_lower) {
        without_value = has_value ? 0 : without_value + 1;
        if (without_value > most_without_value) break;
        damping *= has_value ? growth : growth * growth;
        continue;
      }
      weak = out.sum - sum < options.least_gain * out.sum ? weak + 1 : 0;
      out.x = next;
      out.sum = sum;
      std::swap(at, there);
      damping = std::max(least_damping, damping * fall);
    }
    if (!is_lower) break;
  }
  return out;
}

}  // namespace poise::solvers
