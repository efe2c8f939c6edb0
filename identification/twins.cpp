#include "identification/twins.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "solvers/linear_algebra.hpp"

namespace poise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Runs and states of each that tell mechanisms apart; a scan looks at the first run.
constexpr std::size_t most_runs = 3, states_of_run = 24;
/// First step of a scan in standard errors, its last in sizes of the mechanism, and the ratio of successive steps.
constexpr double first_step = 3.0, last_step = 2.0, ratio = 1.3;
/// Root mean square of e below which motions may be alike, and so near to a known place that it is the same.
constexpr double alike = 10.0;
constexpr int most_iterations = 25;
/// Part of a parameter's reach by which derivatives are taken.
constexpr double difference = 1e-6;

class TwinSearch {
 public:
  TwinSearch(const FitProblem& problem, const Fit& fitted) : problem_(problem), fitted_(fitted) {
    for (std::size_t i = 0; i < fitted.parameters.size(); ++i) reach_.push_back(problem.reach(i));
  }

  std::vector<std::vector<double>> run() {
    std::vector<std::size_t> dimensions;
    for (std::size_t i = 0; i < fitted_.parameters.size(); ++i) {
      const SceneParameter* const number = problem_.number(static_cast<int>(i));
      const bool scanned = number != nullptr && !number->scales_with_force() && !fitted_.estimates[i].withheld;
      if (scanned && fitted_.errors.error[i] > 0) dimensions.push_back(i);
    }
    if (dimensions.empty()) return {};
    choose_runs();
    if (runs_.empty()) return {};
    for (const std::size_t i : dimensions) {
      for (const int side : {-1, 1}) scan(i, side);
    }
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.size < b.size; });
    std::vector<std::vector<double>> out;
    for (Found& one : found_) out.push_back(std::move(one.parameters));
    return out;
  }

 private:
  struct RunAt {
    std::size_t run;
    double equilibrium;
    std::vector<RunModel::State> states;
    MatrixXd responses;   // with the fitted parameters
    VectorXd resolution;  // of each of their columns
  };
  struct Found {
    double size;
    std::vector<double> parameters;
  };

  /// Runs with different known changes of the scene, or parameters of their own, where there are such.
  void choose_runs() {
    std::vector<std::size_t> order;
    const auto differs = [&](std::size_t r) {
      return std::all_of(order.begin(), order.end(), [&](std::size_t s) {
        const auto same = [](const ParameterChange& a, const ParameterChange& b) {
          return a.path == b.path && a.value == b.value;
        };
        const std::vector<ParameterChange>& own = problem_.run(r).run().changes;
        const std::vector<ParameterChange>& others = problem_.run(s).run().changes;
        return problem_.parameters_of(r) != problem_.parameters_of(s) ||
               !std::equal(own.begin(), own.end(), others.begin(), others.end(), same);
      });
    };
    for (std::size_t r = 0; r < problem_.runs() && order.size() < most_runs; ++r) {
      if (differs(r)) order.push_back(r);
    }
    for (std::size_t r = 0; r < problem_.runs() && order.size() < most_runs; ++r) {
      if (std::find(order.begin(), order.end(), r) == order.end()) order.push_back(r);
    }
    for (const std::size_t r : order) {
      const RunModel& model = problem_.run(r);
      const std::vector<double> unknowns = problem_.unknowns_of(r, fitted_.parameters);
      const std::vector<double>& nuisances = fitted_.runs[r].nuisances;
      RunAt at{r, model.equilibrium_is_unknown() ? nuisances[0] : model.equilibrium_at(), {}, {}, {}};
      at.states = model.states(unknowns.data(), nuisances.data(), states_of_run);
      at.responses = model.responses(unknowns.data(), at.equilibrium, at.states);
      if (at.responses.rows() == 0 || !at.responses.allFinite()) continue;
      const Index f = model.freedoms();
      at.resolution.resize(at.responses.cols());
      double finest = INFINITY;
      Index column = f;
      for (std::size_t k = 0; k < model.times().size(); ++k) {
        if (model.times()[k].empty()) continue;
        const VectorXd reading = at.responses.col(column).array() - at.responses.col(column).mean();
        at.resolution[column] = fitted_.weighting.noise[k];
        const double size = reading.norm() / std::sqrt(static_cast<double>(reading.size()));
        if (size > 0) finest = std::min(finest, fitted_.weighting.noise[k] / size);
        ++column;
      }
      if (!std::isfinite(finest)) continue;
      bool moves = true;
      for (Index k = 0; k < f; ++k) {
        at.resolution[k] = finest * at.responses.col(k).norm() / std::sqrt(static_cast<double>(at.responses.rows()));
        moves = moves && at.resolution[k] > 0;
      }
      if (moves) runs_.push_back(std::move(at));
    }
  }

  /// e of the first `runs` runs; empty where a mechanism cannot take a pose.
  VectorXd differences(const std::vector<double>& parameters, std::size_t runs) const {
    VectorXd out;
    for (std::size_t i = 0; i < std::min(runs, runs_.size()); ++i) {
      const RunAt& at = runs_[i];
      const std::vector<double> unknowns = problem_.unknowns_of(at.run, parameters);
      const MatrixXd there = problem_.run(at.run).responses(unknowns.data(), at.equilibrium, at.states);
      if (there.rows() == 0 || !there.allFinite()) return {};
      const MatrixXd e = (there - at.responses) * at.resolution.cwiseInverse().asDiagonal();
      out.conservativeResize(out.size() + e.size());
      out.tail(e.size()) = e.reshaped();
    }
    return out;
  }

  static double size_of(const VectorXd& e) {
    return e.size() == 0 ? INFINITY : e.norm() / std::sqrt(static_cast<double>(e.size()));
  }

  void scan(std::size_t i, int side) {
    const Parameter& p = problem_.parameters()[i];
    std::vector<double> parameters = fitted_.parameters;
    double before_last = 0.0;
    double last = 0.0;
    double last_value = parameters[i];
    for (double step = first_step * fitted_.errors.error[i]; step < last_step * reach_[i]; step *= ratio) {
      const double value = fitted_.parameters[i] + side * step;
      if (value < p.min || value > p.max) break;
      parameters[i] = value;
      const double size = size_of(differences(parameters, 1));
      if (last < before_last && !(last > size)) polish(i, last_value);
      before_last = last;
      last = size;
      last_value = value;
    }
  }

  /// Levenberg and Marquardt from the fitted parameters with one of them elsewhere.
  void polish(std::size_t scanned, double value) {
    std::vector<double> x = fitted_.parameters;
    x[scanned] = value;
    VectorXd e = differences(x, runs_.size());
    const auto n = static_cast<Index>(x.size());
    double damping = 1e-3;
    for (int iteration = 0; iteration < most_iterations && e.size() > 0; ++iteration) {
      MatrixXd rows = MatrixXd::Zero(e.size() + n, n);
      for (Index c = 0; c < n; ++c) {
        const auto at = static_cast<std::size_t>(c);
        std::vector<double> moved = x;
        moved[at] += difference * reach_[at];
        const VectorXd there = differences(moved, runs_.size());
        if (there.size() == 0) return;
        rows.col(c).head(e.size()) = (there - e) / difference;
      }
      const VectorXd lengths = rows.topRows(e.size()).colwise().norm();
      VectorXd right = VectorXd::Zero(rows.rows());
      right.head(e.size()) = e;
      bool moved = false;
      for (; !moved && damping < 1e6; damping *= 10) {
        rows.bottomRows(n) = MatrixXd((std::sqrt(damping) * lengths.array() + 1e-12).matrix().asDiagonal());
        const VectorXd step = solvers::minimum_norm_solution<double>(rows, right);
        std::vector<double> next = x;
        for (Index c = 0; c < n; ++c) {
          const auto at = static_cast<std::size_t>(c);
          const Parameter& p = problem_.parameters()[at];
          next[at] = std::clamp(x[at] - step[c] * reach_[at], p.min, p.max);
        }
        const VectorXd there = differences(next, runs_.size());
        if (!(size_of(there) < size_of(e))) continue;
        const bool settled = size_of(there) > 0.99 * size_of(e) || size_of(there) < 1e-3;
        x = std::move(next);
        e = there;
        moved = true;
        damping = std::max(1e-9, damping / 100);
        if (settled) iteration = most_iterations;
      }
      if (!moved) break;
    }
    if (size_of(e) < alike && is_new(x)) found_.push_back({size_of(e), std::move(x)});
  }

  /// Whether an estimate differs from the fitted ones, and from those of what was found, by some standard errors.
  bool is_new(const std::vector<double>& parameters) const {
    const auto differ = [&](const std::vector<double>& others) {
      for (std::size_t i = 0; i < parameters.size(); ++i) {
        if (fitted_.estimates[i].withheld) continue;
        if (std::abs(parameters[i] - others[i]) > first_step * fitted_.errors.error[i]) return true;
      }
      return false;
    };
    return differ(fitted_.parameters) &&
           std::all_of(found_.begin(), found_.end(), [&](const Found& one) { return differ(one.parameters); });
  }

  const FitProblem& problem_;
  const Fit& fitted_;
  std::vector<double> reach_;
  std::vector<RunAt> runs_;
  std::vector<Found> found_;
};

}  // namespace

std::vector<std::vector<double>> twins(const FitProblem& problem, const Fit& fitted) {
  return TwinSearch(problem, fitted).run();
}

}  // namespace poise
