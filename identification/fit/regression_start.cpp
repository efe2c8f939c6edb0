#include "identification/fit/regression_start.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

/// All runs together have about the first number of states, and each has one between the others.
constexpr std::size_t most_states = 2000, least_states_of_run = 20, most_states_of_run = 400;
constexpr int most_regressions = 20, most_halvings = 6;
/// A number is moved by this part of its scale for a difference.
constexpr double regression_step = 1e-5;
/// The sum falls by less than this part of it at the end.
constexpr double regression_flat = 1e-4;

class Regression {
 public:
  Regression(const FitProblem& problem, const std::vector<Record>& records) : problem_(problem) {
    const std::size_t count =
        std::clamp(most_states / std::max<std::size_t>(problem.runs(), 1), least_states_of_run, most_states_of_run);
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      states_.push_back(
          problem.run(r).states_from_readings(problem.unknowns_of(r, problem.starts()).data(), records[r], count));
      if (states_.back().empty()) return;
      for (int k = 0; k < problem.run(r).freedoms(); ++k) {
        double square = 0.0;
        for (const RunModel::ReadState& state : states_.back()) {
          const double a = state.a[static_cast<std::size_t>(k)];
          square += a * a / static_cast<double>(count);
        }
        weights_.push_back(square > 0 ? 1 / std::sqrt(square) : 0.0);
      }
    }
    applies_ = problem.runs() > 0;
  }

  bool applies() const { return applies_; }

  /// Empty where a motion cannot take one of the states.
  Eigen::VectorXd residuals(const std::vector<double>& parameters) const {
    std::vector<double> out;
    std::size_t weight = 0;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const Eigen::MatrixXd alpha =
          problem_.run(r).accelerations(problem_.unknowns_of(r, parameters).data(), states_[r]);
      if (alpha.rows() == 0 || !alpha.allFinite()) return {};
      for (Eigen::Index k = 0; k < alpha.cols(); ++k, ++weight) {
        for (Eigen::Index s = 0; s < alpha.rows(); ++s) {
          const double read = states_[r][static_cast<std::size_t>(s)].a[static_cast<std::size_t>(k)];
          out.push_back(weights_[weight] * (alpha(s, k) - read));
        }
      }
    }
    return Eigen::Map<Eigen::VectorXd>(out.data(), std::ssize(out));
  }

  /// One column for each parameter, of its change over its scale.
  Eigen::MatrixXd slopes(const std::vector<double>& parameters, const Eigen::VectorXd& here) const {
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(here.size(), std::ssize(parameters));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      const Parameter& p = problem_.parameters()[i];
      std::vector<double> moved = parameters;
      const double by = parameters[i] + regression_step * p.scale > p.max ? -regression_step : regression_step;
      moved[i] += by * p.scale;
      const Eigen::VectorXd there = residuals(moved);
      if (there.size() == here.size()) out.col(static_cast<Eigen::Index>(i)) = (there - here) / by;
    }
    return out;
  }

 private:
  const FitProblem& problem_;
  std::vector<std::vector<RunModel::ReadState>> states_;
  std::vector<double> weights_;  // of each run's freedoms
  bool applies_ = false;
};

}  // namespace

std::optional<std::vector<double>> start_from_regression(const FitProblem& problem,
                                                         const std::vector<Record>& records) {
  const Regression regression(problem, records);
  if (!regression.applies()) return std::nullopt;
  std::vector<double> parameters = problem.starts();
  Eigen::VectorXd here = regression.residuals(parameters);
  if (here.size() == 0) return std::nullopt;
  for (int iteration = 0; iteration < most_regressions; ++iteration) {
    const Eigen::MatrixXd slopes = regression.slopes(parameters, here);
    if (slopes.isZero(0.0)) return std::nullopt;
    const Eigen::VectorXd change = solvers::minimum_norm_solution<double>(slopes, -here, 1e-6);
    const double before = here.squaredNorm();
    double part = 1.0;
    for (int halving = 0; halving < most_halvings; ++halving, part /= 2) {
      std::vector<double> next = parameters;
      for (std::size_t i = 0; i < next.size(); ++i) {
        const Parameter& p = problem.parameters()[i];
        next[i] = std::clamp(next[i] + part * p.scale * change[static_cast<Eigen::Index>(i)], p.min, p.max);
      }
      const Eigen::VectorXd there = regression.residuals(next);
      if (there.size() == 0 || !(there.squaredNorm() < before)) continue;
      parameters = std::move(next);
      here = there;
      break;
    }
    if (!(here.squaredNorm() < (1 - regression_flat) * before)) break;
  }
  return parameters;
}

}  // namespace poise
