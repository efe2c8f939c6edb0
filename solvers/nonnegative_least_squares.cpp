#include "solvers/nonnegative_least_squares.hpp"

#include <algorithm>
#include <limits>

#include "solvers/linear_algebra.hpp"

namespace poise::solvers {
namespace {

constexpr double gain_rounding = 64 * std::numeric_limits<double>::epsilon();

}  // namespace

Eigen::VectorXd nonnegative_least_squares(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  const Eigen::Index n = a.cols();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Index> positive;
  // Columns that depend on the positive ones add nothing, until these change.
  std::vector<Eigen::Index> dependent;
  const auto columns = [&] {
    Eigen::MatrixXd out(a.rows(), static_cast<Eigen::Index>(positive.size()));
    for (std::size_t k = 0; k < positive.size(); ++k) out.col(static_cast<Eigen::Index>(k)) = a.col(positive[k]);
    return out;
  };
  const double scale = n > 0 && a.rows() > 0 ? a.cwiseAbs().maxCoeff() * b.cwiseAbs().maxCoeff() : 0.0;
  for (Eigen::Index pass = 0; pass < 3 * n; ++pass) {
    const Eigen::VectorXd gain = a.transpose() * (b - a * x);
    Eigen::Index enters = -1;
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool is_out = std::find(positive.begin(), positive.end(), j) == positive.end() &&
                          std::find(dependent.begin(), dependent.end(), j) == dependent.end();
      if (is_out && gain[j] > gain_rounding * scale && (enters < 0 || gain[j] > gain[enters])) enters = j;
    }
    if (enters < 0) break;
    positive.push_back(enters);
    for (;;) {
      const LeastSquares<double> part(columns(), known_to::solution);
      if (part.rank() < static_cast<Eigen::Index>(positive.size())) {
        positive.pop_back();
        dependent.push_back(enters);
        break;
      }
      dependent.clear();
      const Eigen::VectorXd s = part.solve(b);
      double step = 1.0;
      for (std::size_t k = 0; k < positive.size(); ++k) {
        const double now = x[positive[k]];
        const double next = s[static_cast<Eigen::Index>(k)];
        if (next <= 0.0) step = std::min(step, now > next ? now / (now - next) : 0.0);
      }
      for (std::size_t k = 0; k < positive.size(); ++k) {
        double& now = x[positive[k]];
        now += step * (s[static_cast<Eigen::Index>(k)] - now);
      }
      if (step >= 1.0) break;
      std::erase_if(positive, [&](Eigen::Index j) {
        if (x[j] > gain_rounding * x.cwiseAbs().maxCoeff()) return false;
        x[j] = 0.0;
        return true;
      });
      if (positive.empty()) break;
    }
  }
  return x;
}

std::vector<bool> zeros_of_least_norm(const Eigen::MatrixXd& e, const Eigen::VectorXd& feasible,
                                      const Eigen::MatrixXd& c_matrix, const Eigen::VectorXd& c) {
  const Eigen::Index n = feasible.size();
  std::vector<bool> zero(static_cast<std::size_t>(n), false);
  const Eigen::MatrixXd free = null_space<double>(e, known_to::solution);
  const Eigen::Index k = free.cols();
  const double size = n > 0 ? feasible.maxCoeff() : 0.0;
  if (k == 0 || size <= 0.0) {
    for (Eigen::Index j = 0; j < n; ++j) zero[static_cast<std::size_t>(j)] = feasible[j] <= 0.0;
    return zero;
  }
  // Forces over their size, so that constraints and right sides are of one scale.
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(std::max(c_matrix.rows(), k + 1), k + 1);
  moved.topLeftCorner(c_matrix.rows(), k) = c_matrix * free;
  moved.col(k).head(c_matrix.rows()) = (c_matrix * feasible + c) / size;
  const Eigen::MatrixXd factors = triangular_factor(moved);
  const Eigen::MatrixXd r = factors.topLeftCorner(k, k);
  const Eigen::MatrixXd directions = r.transpose().triangularView<Eigen::Lower>().solve(free.transpose());
  Eigen::MatrixXd system(k + 1, n);
  system.topRows(k) = directions;
  system.row(k) = (directions.transpose() * factors.col(k).head(k) - feasible / size).transpose();
  const Eigen::VectorXd multipliers = nonnegative_least_squares(system, Eigen::VectorXd::Unit(k + 1, k));
  for (Eigen::Index j = 0; j < n; ++j) zero[static_cast<std::size_t>(j)] = multipliers[j] > 0.0;
  return zero;
}

}  // namespace poise::solvers
