#include "identification/fit/private/twins.hpp"

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
constexpr std::size_t most_started_runs = 3, states_of_run = 24;
/// First step of a scan in standard errors, its last in sizes of the mechanism, and the ratio of successive steps.
constexpr double first_twin_step = 3.0, last_step = 8.0, ratio = 1.3;
/// Root mean square of e below which motions may be alike, and so near to a known place that it is the same.
constexpr double alike_costs = 10.0;
constexpr int most_twin_iterations = 25;
/// Degrees of freedom that may swing the other way each by itself; with more, all do.
constexpr int most_sides = 3;
/// Part of a parameter's reach by which derivatives are taken.
constexpr double difference = 1e-6;

class TwinSearch {
 public:
  TwinSearch(const FitProblem& problem, const Fit& fitted)
      : problem_(problem), fitted_(fitted), begin_(fitted.parameters) {
    for (std::size_t i = 0; i < fitted.parameters.size(); ++i) reach_.push_back(problem.reach(i));
  }

  std::vector<FitPoint> run() {
    std::vector<std::size_t> dimensions;
    for (std::size_t i = 0; i < fitted_.parameters.size(); ++i) {
      const SceneParameter* const number = problem_.number(static_cast<int>(i));
      const bool scanned = number != nullptr && !number->scales_with_force() && !fitted_.estimates[i].withheld;
      if (scanned && fitted_.errors.error[i] > 0) dimensions.push_back(i);
    }
    const bool otherwise = may_swing_otherwise();
    if (dimensions.empty() && !otherwise) return {};
    choose_runs();
    if (runs_.empty()) return {};
    scan(dimensions);
    if (otherwise) {
      const int freedoms = problem_.run(0).freedoms();
      const int all = (1 << std::min(freedoms, most_sides)) - 1;
      for (int turned = freedoms > most_sides ? all : 1; turned <= all; ++turned) {
        mirror([&](int k) { return k >= most_sides || (turned & (1 << k)) != 0; });
        polish(begin_);
        scan(dimensions);
      }
    }
    std::sort(found_.begin(), found_.end(), [](const Found& a, const Found& b) { return a.size < b.size; });
    std::vector<FitPoint> out;
    for (Found& one : found_) out.push_back(std::move(one.point));
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
    FitPoint point;
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
    for (std::size_t r = 0; r < problem_.runs() && order.size() < most_started_runs; ++r) {
      if (differs(r)) order.push_back(r);
    }
    for (std::size_t r = 0; r < problem_.runs() && order.size() < most_started_runs; ++r) {
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

  /// Whether the starts of all runs are unknown, of the same coordinates, one of which no sensor reads as it is.
  bool may_swing_otherwise() const {
    const std::vector<Sensor>& sensors = problem_.experiment().sensors;
    bool hidden = false;
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      const RunModel& model = problem_.run(r);
      if (!model.start_is_unknown() || model.independent() != problem_.run(0).independent()) return false;
      if (model.equilibrium_is_unknown() && model.freedoms() > 1) return false;
      int read = 0;
      for (std::size_t k = 0; k < sensors.size(); ++k) {
        const auto of_it = [&](const SensorNumber& number) { return number.sensor == k; };
        const std::vector<SensorNumber>& numbers = model.sensor_numbers();
        const bool as_it_is = sensors[k].reads_coordinate() && std::none_of(numbers.begin(), numbers.end(), of_it);
        if (!model.times()[k].empty() && as_it_is) ++read;
      }
      hidden = hidden || read < model.freedoms();
    }
    return hidden;
  }

  /// From here on s is -1 for the degrees of freedom that are turned, and the offsets a follow the parameters.
  template <class IsTurned>
  void mirror(const IsTurned& is_turned) {
    begin_ = fitted_.parameters;
    reach_.resize(begin_.size());
    const RunModel& first = problem_.run(0);
    const std::vector<int>& independent = first.independent();
    signs_ = VectorXd::Ones(static_cast<Index>(independent.size()));
    const std::size_t start = first.equilibrium_is_unknown() ? 1 : 0;
    const std::vector<Dimension> dimensions = first.nuisance_dimensions();
    for (std::size_t k = 0; k < independent.size(); ++k) {
      reach_.push_back(dimensions[start + k].length == 0 ? 1.0 : first.size());
      begin_.push_back(0.0);
      if (!is_turned(static_cast<int>(k))) continue;
      signs_[static_cast<Index>(k)] = -1.0;
      double sum = 0.0;
      std::size_t count = 0;
      for (const RunAt& at : runs_) {
        for (const RunModel::State& state : at.states) sum += state.q[static_cast<std::size_t>(independent[k])];
        count += at.states.size();
      }
      begin_.back() = 2.0 * sum / static_cast<double>(count);
    }
  }

  /// The equilibrium and the states of a run that x leads to.
  std::pair<double, std::vector<RunModel::State>> moved(const RunAt& at, const std::vector<double>& x) const {
    std::pair<double, std::vector<RunModel::State>> out{at.equilibrium, at.states};
    if (signs_.size() == 0) return out;
    const RunModel& model = problem_.run(at.run);
    const double* const offsets = &x[fitted_.parameters.size()];
    if (model.equilibrium_is_unknown()) out.first = offsets[0] + signs_[0] * at.equilibrium;
    for (RunModel::State& state : out.second) {
      for (Index k = 0; k < signs_.size(); ++k) {
        const auto c = static_cast<std::size_t>(model.independent()[static_cast<std::size_t>(k)]);
        state.q[c] = offsets[k] + signs_[k] * state.q[c];
        state.v[c] *= signs_[k];
      }
    }
    return out;
  }

  /// The fit that x leads to.
  FitPoint point(const std::vector<double>& x) const {
    const std::size_t n = fitted_.parameters.size();
    FitPoint out{{x.begin(), x.begin() + static_cast<std::ptrdiff_t>(n)}, {}};
    for (std::size_t r = 0; r < problem_.runs(); ++r) {
      std::vector<double>& nuisances = out.nuisances.emplace_back(fitted_.runs[r].nuisances);
      if (signs_.size() == 0) continue;
      const std::size_t start = problem_.run(r).equilibrium_is_unknown() ? 1 : 0;
      const auto f = static_cast<std::size_t>(signs_.size());
      if (start > 0) nuisances[0] = x[n] + signs_[0] * nuisances[0];
      for (std::size_t k = 0; k < f; ++k) {
        const double sign = signs_[static_cast<Index>(k)];
        nuisances[start + k] = x[n + k] + sign * nuisances[start + k];
        nuisances[start + f + k] *= sign;
      }
    }
    return out;
  }

  /// e of the first `runs` runs at x = (p, a); empty where a mechanism cannot take a pose.
  VectorXd differences(const std::vector<double>& x, std::size_t runs) const {
    VectorXd out;
    const std::vector<double> parameters(x.begin(), x.begin() + static_cast<std::ptrdiff_t>(fitted_.parameters.size()));
    for (std::size_t i = 0; i < std::min(runs, runs_.size()); ++i) {
      const RunAt& at = runs_[i];
      const RunModel& model = problem_.run(at.run);
      const std::vector<double> unknowns = problem_.unknowns_of(at.run, parameters);
      const auto [equilibrium, states] = moved(at, x);
      MatrixXd there = model.responses(unknowns.data(), equilibrium, states);
      if (there.rows() == 0 || !there.allFinite()) return {};
      for (Index k = 0; k < signs_.size(); ++k) there.col(k) *= signs_[k];
      const MatrixXd e = (there - at.responses) * at.resolution.cwiseInverse().asDiagonal();
      out.conservativeResize(out.size() + e.size());
      out.tail(e.size()) = e.reshaped();
    }
    return out;
  }

  static double size_of(const VectorXd& e) {
    return e.size() == 0 ? INFINITY : e.norm() / std::sqrt(static_cast<double>(e.size()));
  }

  void scan(const std::vector<std::size_t>& dimensions) {
    for (const std::size_t i : dimensions) {
      for (const int side : {-1, 1}) scan(i, side);
    }
  }

  void scan(std::size_t i, int side) {
    const Parameter& p = problem_.parameters()[i];
    std::vector<double> x = begin_;
    double before_last = 0.0;
    double last = 0.0;
    double last_value = x[i];
    for (double step = first_twin_step * fitted_.errors.error[i]; step < last_step * reach_[i]; step *= ratio) {
      const double value = fitted_.parameters[i] + side * step;
      if (value < p.min || value > p.max) break;
      x[i] = value;
      const double size = size_of(differences(x, 1));
      if (last < before_last && !(last > size)) {
        std::vector<double> least = begin_;
        least[i] = last_value;
        polish(std::move(least));
      }
      before_last = last;
      last = size;
      last_value = value;
    }
  }

  /// Levenberg and Marquardt from x = (p, a).
  void polish(std::vector<double> x) {
    VectorXd e = differences(x, runs_.size());
    const auto n = static_cast<Index>(x.size());
    double damping = 1e-3;
    for (int iteration = 0; iteration < most_twin_iterations && e.size() > 0; ++iteration) {
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
          next[at] = x[at] - step[c] * reach_[at];
          if (at >= fitted_.parameters.size()) continue;
          const Parameter& p = problem_.parameters()[at];
          next[at] = std::clamp(next[at], p.min, p.max);
        }
        const VectorXd there = differences(next, runs_.size());
        if (!(size_of(there) < size_of(e))) continue;
        const bool settled = size_of(there) > 0.99 * size_of(e) || size_of(there) < 1e-3;
        x = std::move(next);
        e = there;
        moved = true;
        damping = std::max(1e-9, damping / 100);
        if (settled) iteration = most_twin_iterations;
      }
      if (!moved) break;
    }
    if (size_of(e) < alike_costs && is_new(x)) found_.push_back({size_of(e), point(x)});
  }

  /// Whether an estimate differs from the fitted ones, and from those of what was found, by some standard errors.
  bool is_new(const std::vector<double>& parameters) const {
    const auto differ = [&](const std::vector<double>& others) {
      for (std::size_t i = 0; i < others.size(); ++i) {
        if (fitted_.estimates[i].withheld) continue;
        if (std::abs(parameters[i] - others[i]) > first_twin_step * fitted_.errors.error[i]) return true;
      }
      return false;
    };
    return differ(fitted_.parameters) &&
           std::all_of(found_.begin(), found_.end(), [&](const Found& one) { return differ(one.point.parameters); });
  }

  const FitProblem& problem_;
  const Fit& fitted_;
  VectorXd signs_;             // s of each degree of freedom; none where all are 1 and a is 0
  std::vector<double> begin_;  // x from which a scan moves one dimension
  std::vector<double> reach_;  // of the components of x
  std::vector<RunAt> runs_;
  std::vector<Found> found_;
};

}  // namespace

std::vector<FitPoint> twins(const FitProblem& problem, const Fit& fitted) { return TwinSearch(problem, fitted).run(); }

}  // namespace poise
