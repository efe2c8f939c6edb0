#include "identification/fit/private/describe_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <boost/math/distributions/normal.hpp>
#include <fmt/format.h>

#include "identification/fit/autocorrelation.hpp"
#include "identification/fit/private/verdict.hpp"
#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

// --- residuals ------------------------------------------------------------------------------------------------------

double sum_of_squares(const std::vector<double>& e) {
  double out = 0.0;
  for (const double x : e) out += x * x;
  return out;
}

/// Describes run r, which has the residuals e.
RunFit run_as_fitted(const FitTask& task, std::size_t r, const std::vector<double>& nuisances, const Residuals& e,
                     const Weighting& weighting, const StandardErrors& errors) {
  RunFit out;
  out.name = task.problem.run(r).run().name;
  out.nuisances = nuisances;
  // One of all that are compared, of runs and sensors, exceeds it by chance.
  const std::size_t sensors = task.problem.experiment().sensors.size();
  const double remarkable = boost::math::quantile(
      complement(boost::math::normal(), chance_level / static_cast<double>(2 * task.problem.runs() * sensors)));
  for (std::size_t k = 0; k < sensors; ++k) {
    const auto samples = static_cast<double>(e[k].size());
    const double noise = weighting.noise[k];
    out.rms.push_back(e[k].empty() ? not_a_number : noise * std::sqrt(sum_of_squares(e[k]) / samples));
    const Autocorrelation lagged = autocorrelation(task.records[r].sensors[k].time, e[k]);
    out.autocorrelation.push_back(lagged.value);
    out.correlated.push_back(std::abs(lagged.value) * std::sqrt(1.0 + lagged.pairs) > remarkable);
    out.mean.push_back(-noise * std::accumulate(e[k].begin(), e[k].end(), 0.0) / samples);
    out.shifted.push_back(!errors.runs_noise.empty() && std::abs(errors.runs_noise[r][k].offset) > remarkable);
  }
  return out;
}

/// Returns the standard deviation of the root mean square of all residuals over their noise; `readings` per sensor.
double size_error(const FitTask& task, const StandardErrors& errors, const std::vector<std::size_t>& readings) {
  if (errors.sensors.empty()) return std::sqrt(0.5 / task.degrees_of_freedom());
  double variance = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < readings.size(); ++k) {
    const double degrees = errors.sensors[k].degrees;
    const auto count = static_cast<double>(readings[k]);
    if (degrees > 0) variance += count * count / (2 * degrees);
    all += count;
  }
  return std::sqrt(variance) / all;
}

void add_residuals(const FitTask& task, const WeightedMinimum& at, const LinearFit& linear, Fit& out) {
  const std::size_t sensors = task.problem.experiment().sensors.size();
  std::vector<double> squares(sensors, 0.0);
  std::vector<std::size_t> readings(sensors, 0);
  double squares_over_noise = 0.0;
  for (std::size_t r = 0; r < task.problem.runs(); ++r) {
    Residuals e = residuals_in(linear.runs[r]);
    e.resize(sensors);  // of a motion that fails, or an interrupt has ended
    out.runs.push_back(run_as_fitted(task, r, at.minimum.point.nuisances[r], e, at.weighting, linear.errors));
    for (std::size_t k = 0; k < e.size(); ++k) {
      const double noise = at.weighting.noise[k];
      squares[k] += sum_of_squares(e[k]) * noise * noise;
      readings[k] += e[k].size();
      for (const double x : e[k]) squares_over_noise += x * x;
    }
  }
  out.residual_over_noise = std::sqrt(squares_over_noise / task.degrees_of_freedom());
  out.residual_over_noise_sigma = size_error(task, linear.errors, readings);
  for (std::size_t k = 0; k < sensors; ++k) {
    out.rms.push_back(std::sqrt(squares[k] / static_cast<double>(readings[k])));
  }
  out.outliers = outliers(task.problem, linear.runs, at.weighting);
}

// --- estimates ------------------------------------------------------------------------------------------------------

/// Describes parameter i, which has this value; `fitted` has its status, identifiability and errors.
Estimate estimate_of(const FitProblem& problem, std::size_t i, double value, const Fit& fitted) {
  const Parameter& p = problem.parameters()[i];
  const Unknown& unknown = problem.unknown_of(i);
  Estimate out;
  out.name = p.name;
  out.unit = unknown.unit;
  out.value = value + unknown.includes;
  out.truth = p.truth + unknown.includes;
  if (fitted.identifiability.ok) {
    const bool known = std::isfinite(fitted.identifiability.standard_error[i]);
    out.standard_error = known ? fitted.errors.error[i] : INFINITY;
    const double reach = known ? fitted.errors.reach[i] : INFINITY;
    out.low = out.value - reach;
    out.high = out.value + reach;
    if (!fitted.identifiability.identifiable[i]) out.why = "not identifiable from these data";
    const double scale = problem.scale_of(i, out.value).size;
    out.poorly_determined = scale > 0 && out.standard_error > scale / identifiable_from;
  }
  const double near = 1e-9 * p.scale;
  // Along a null the fit may stop anywhere.
  const bool free = fitted.identifiability.ok && std::isinf(out.standard_error);
  if (!free && (value <= p.min + near || value >= p.max - near)) {
    out.at_bound = true;
    out.why = fmt::format("at the bound {:.6g}", out.value / out.unit);
  }
  if (fitted.status == FitStatus::ambiguous) out.why = "several minima";
  out.withheld = !out.why.empty();
  return out;
}

/// Sets standard errors of combinations, and correlations, by what the residuals allow.
void lead_with_residuals(Fit& out) {
  std::vector<double> shown;
  for (const Estimate& estimate : out.estimates) shown.push_back(estimate.value);
  for (Identifiability::Combination& known : out.identifiability.combinations) {
    known.standard_error = out.errors.of(known.gradient(shown));
  }
  auto& correlation = out.identifiability.correlation;
  const Eigen::VectorXd error = out.errors.covariance.diagonal().cwiseSqrt();
  for (std::size_t i = 0; i < correlation.size(); ++i) {
    for (std::size_t j = 0; j < correlation.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      if (correlation[i][j]) correlation[i][j] = out.errors.covariance(row, column) / (error[row] * error[column]);
    }
  }
}

/// Fills in what both forms of a result have.
Fit outline_of(const FitTask& task, const FoundMinimum& found, const WeightedMinimum& at, const FitEffort& effort) {
  Fit out;
  out.status = found.status;
  out.why = found.why;
  out.start = found.start;
  if (at.minimum.is_reached()) out.cost = at.minimum.cost;
  out.parameters = at.minimum.point.parameters;
  out.weighting = at.weighting;
  out.readings = task.readings;
  out.degrees_of_freedom = task.degrees_of_freedom();
  set_effort(out, effort);
  return out;
}

}  // namespace

Fit describe_fit(const FitTask& task, const FoundMinimum& found, const WeightedMinimum& at, const LinearFit& linear,
                 const FitEffort& effort) {
  Fit out = outline_of(task, found, at, effort);
  out.alternatives = found.alternatives;
  out.identifiability = linear.identifiability;
  out.errors = linear.errors;
  add_residuals(task, at, linear, out);
  for (std::size_t r = 0; r < linear.runs.size() && out.status == FitStatus::not_run; ++r) {
    if (linear.runs[r].rows.size() > 0) continue;
    out.status = task.stopped() ? FitStatus::interrupted : FitStatus::failed;
    out.why = task.stopped()
                  ? "interrupted while the minimum was examined; the values reached are shown"
                  : fmt::format("the motion of run \"{}\" cannot be computed at the values reached", out.runs[r].name);
  }
  if (out.status == FitStatus::not_run) {
    FitVerdict verdict = verdict_on(task.problem, out, found.is_aliased);
    out.status = verdict.status;
    out.why = std::move(verdict.why);
  }
  for (std::size_t i = 0; i < task.problem.parameters().size(); ++i) {
    out.estimates.push_back(estimate_of(task.problem, i, out.parameters[i], out));
  }
  if (out.identifiability.ok) lead_with_residuals(out);
  return out;
}

Fit values_of_fit(const FitTask& task, const FoundMinimum& found, const WeightedMinimum& at, const FitEffort& effort) {
  Fit out = outline_of(task, found, at, effort);
  for (std::size_t r = 0; at.minimum.is_reached() && r < task.problem.runs(); ++r) {
    RunFit& run = out.runs.emplace_back();
    run.name = task.problem.run(r).run().name;
    run.nuisances = at.minimum.point.nuisances[r];
  }
  if (out.status == FitStatus::not_run) out.status = FitStatus::converged;
  for (std::size_t i = 0; out.status == FitStatus::interrupted && i < out.parameters.size(); ++i) {
    out.estimates.push_back(estimate_of(task.problem, i, out.parameters[i], out));
  }
  return out;
}

void set_effort(Fit& fit, const FitEffort& effort) {
  fit.tries = effort.tries;
  fit.iterations = effort.iterations;
  fit.evaluations = effort.evaluations;
  fit.check_evaluations = effort.check_evaluations;
}

void leave_out(Fit& fit, const std::string& what) {
  std::vector<std::string>& all = fit.unexamined;
  if (std::find(all.begin(), all.end(), what) == all.end()) all.push_back(what);
}

void withhold(Fit& fit, std::size_t parameter, const std::string& why) {
  fit.estimates[parameter].withheld = true;
  fit.estimates[parameter].why = why;
  fit.identifiability.identifiable[parameter] = false;
}

}  // namespace poise
