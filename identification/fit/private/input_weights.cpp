#include "identification/fit/private/input_weights.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include <boost/math/tools/minima.hpp>

#include "identification/fit/private/linear_fit.hpp"
#include "identification/fit/projection.hpp"
#include "solvers/parallel.hpp"

namespace poise {
namespace {

/// How often the errors are taken at the values reached.
constexpr int rounds = 3;
/// Over so many standard errors of a parameter d log det S is a difference.
constexpr double step_of_difference = 0.3;

/// log det S of run r at other parameters; NaN where its motion fails.
double log_determinant(const FitProblem& problem, std::size_t r, const std::vector<double>& parameters,
                       const std::vector<double>& nuisances, const LinearRun& like, const Weighting& weighting) {
  const auto errors =
      problem.run(r).input_errors(problem.unknowns_of(r, parameters).data(), nuisances.data(), problem.accuracy(r));
  if (errors == nullptr) return NAN;
  Eigen::MatrixXd none(like.rows.rows(), 0);
  return errors->times(std::min(1.0, weighting.input_noise)).whiten(none, like.first, weighting.noise);
}

/// g of run r, by all parameters.
Eigen::VectorXd slopes(const FitTask& task, std::size_t r, const FitPoint& at, const LinearFit& linear,
                       const Weighting& weighting) {
  const FitProblem& problem = task.problem;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(std::ssize(problem.parameters()));
  for (const int p : problem.parameters_of(r)) {
    const double error = std::sqrt(linear.identifiability.covariance(p, p));
    if (!(error > 0) || !std::isfinite(error)) continue;
    const Parameter& parameter = problem.parameters()[static_cast<std::size_t>(p)];
    std::vector<double> low = at.parameters, high = at.parameters;
    double &below = low[static_cast<std::size_t>(p)], &above = high[static_cast<std::size_t>(p)];
    below = std::max(parameter.min, below - step_of_difference * error);
    above = std::min(parameter.max, above + step_of_difference * error);
    if (!(below < above)) continue;
    const auto there = [&](const std::vector<double>& parameters) {
      return log_determinant(problem, r, parameters, at.nuisances[r], linear.runs[r], weighting);
    };
    const double slope = (there(high) - there(low)) / (2 * (above - below));
    if (std::isfinite(slope)) out[p] = slope;
  }
  return out;
}

/// The errors with their offsets.
void add_offsets(const FitTask& task, Minimum& at, Weighting& weighting) {
  const FitProblem& problem = task.problem;
  Minimum here = at;
  here.computed.clear();
  const LinearFit linear = linearize(task, weighting, here);
  if (!linear.identifiability.ok || !task.options.held.empty()) return;
  std::vector<Eigen::VectorXd> own(problem.runs());
  solvers::parallel_for(problem.runs(), {.jobs = task.options.jobs}, [&](std::size_t r) {
    if (weighting.inputs[r] != nullptr) own[r] = slopes(task, r, at.point, linear, weighting);
  });
  Eigen::VectorXd g = Eigen::VectorXd::Zero(std::ssize(problem.parameters()));
  for (const Eigen::VectorXd& of_run : own) {
    if (of_run.size() > 0) g += of_run;
  }
  const Eigen::VectorXd change = linear.identifiability.covariance * g;
  if (!change.allFinite()) return;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const LinearRun& run = linear.runs[r];
    if (weighting.inputs[r] == nullptr || run.rows.size() == 0) continue;
    const Eigen::Index nuisances = problem.run(r).nuisances();
    const Eigen::MatrixXd a =
        unexplained(run.rows.middleCols(nuisances, problem.run(r).unknowns()), run.rows.leftCols(nuisances));
    weighting.inputs[r] = std::make_shared<const InputErrors>(
        weighting.inputs[r]->with_offset(a * change(problem.parameters_of(r)), run.first));
  }
}

bool guesses_noise(const FitProblem& problem, const Weighting& weighting) {
  for (std::size_t k = 0; k < weighting.noise.size(); ++k) {
    if (estimates_noise(problem, weighting, k)) return true;
  }
  return false;
}

/// -2 log likelihood of the residuals where the noise of inputs is so many times what is stated.
double misfit_with(double factor, const std::vector<LinearRun>& runs, const Weighting& weighting) {
  double sum = 0.0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    if (weighting.inputs[r] == nullptr || runs[r].rows.size() == 0) continue;
    Eigen::MatrixXd residuals = runs[r].rows.rightCols(1);
    const double determinant = weighting.inputs[r]->times(factor).whiten(residuals, runs[r].first, weighting.noise);
    sum += determinant + residuals.squaredNorm();
  }
  return sum;
}

/// Weighting::input_noise at a minimum; `weighting` has the errors of the noise as it is stated.
double noise_shown(const FitTask& task, const FitPoint& at, const Weighting& weighting) {
  constexpr double beyond_chance = 15.1;  // of chi squared with one degree of freedom, once in 10^4
  constexpr int decades = 12;
  const FitProblem& problem = task.problem;
  Weighting without = weighting;
  without.inputs.clear();
  std::vector<LinearRun> runs(problem.runs());
  solvers::parallel_for(problem.runs(), {.jobs = task.options.jobs}, [&](std::size_t r) {
    runs[r] =
        problem.linearized(r, at.parameters, at.nuisances[r], &task.records[r], INFINITY, problem.accuracy(r), without);
  });
  const auto misfit = [&](double power) { return misfit_with(std::pow(10.0, power), runs, weighting); };
  const double stated = misfit(0.0);
  double best = 0.0, least = stated;
  for (int power = -decades; power <= decades; ++power) {
    const double there = misfit(power);
    if (!(there < least)) continue;
    best = power;
    least = there;
  }
  constexpr int bits = 20;
  const auto [power, lowest] = boost::math::tools::brent_find_minima(misfit, best - 1, best + 1, bits);
  return stated - lowest > beyond_chance ? std::pow(10.0, power) : 1.0;
}

}  // namespace

WeightedMinimum weigh_by_input_errors(const FitTask& task, WeightedMinimum from, FitEffort& effort) {
  WeightedMinimum out = std::move(from);
  for (int round = 0; round < rounds && !task.stopped(); ++round) {
    Weighting weighting = out.weighting;
    const FitPoint& point = out.minimum.point;
    weighting.inputs = task.problem.input_errors(point.parameters, point.nuisances, task.options.jobs);
    if (weighting.inputs.empty()) break;
    task.say("weighing the readings by the noise of inputs");
    // A first guess of a sensor's noise contains what that of inputs does.
    if (round > 0 || !guesses_noise(task.problem, weighting)) {
      weighting.input_noise = noise_shown(task, point, weighting);
    }
    if (weighting.input_noise < 1) {
      for (auto& errors : weighting.inputs) {
        if (errors) errors = std::make_shared<const InputErrors>(errors->times(weighting.input_noise));
      }
    }
    add_offsets(task, out.minimum, weighting);
    Minimum next = minimise(task, weighting, point, 1.0, effort);
    if (!next.is_reached()) break;
    out = {std::move(next), std::move(weighting)};
    if (task.options.from == nullptr) out = estimate_noise(task, std::move(out), effort);
  }
  return out;
}

}  // namespace poise
