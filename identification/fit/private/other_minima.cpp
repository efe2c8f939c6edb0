#include "identification/fit/private/other_minima.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/private/alternatives.hpp"
#include "identification/fit/private/describe_fit.hpp"
#include "identification/fit/private/following_nuisances.hpp"
#include "identification/fit/private/twins.hpp"
#include "solvers/random_stream.hpp"

namespace poise {
namespace {

/// So many minima with other dimensions are compared. A number agrees in all of them where it changes by less than this
/// part of its standard error.
constexpr std::size_t most_twins = 3;
constexpr double agrees_within = 0.3;
/// Parameters that are tried where sensors do not read all states: so many, changed by up to this factor.
constexpr std::uint64_t most_far = 24;
constexpr double far_factor = 3.0;
/// A part of a parameter's reach that changes frequencies, if it does, by more than this part squared.
constexpr double slightly = 1e-3;

/// Says whether shown values differ by more than the intervals say.
bool differ(const Fit& fitted, const std::vector<double>& a, const std::vector<double>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Estimate& estimate = fitted.estimates[i];
    if (estimate.withheld) continue;
    const double reach = std::max(estimate.value - estimate.low, estimate.high - estimate.value);
    if (std::abs(a[i] - b[i]) > reach) return true;
  }
  return false;
}

// --- other states ---------------------------------------------------------------------------------------------------

/// Says whether the sensors of a run read fewer angles and travels than it has degrees of freedom.
bool hides_states(const FitProblem& problem) {
  const std::vector<Sensor>& sensors = problem.experiment().sensors;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    int read = 0;
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      if (!problem.run(r).times()[k].empty() && sensors[k].reads_coordinate()) ++read;
    }
    if (read < problem.run(r).freedoms()) return true;
  }
  return false;
}

/// Lists the parameters that the frequencies depend on.
std::vector<std::size_t> that_change(const FitProblem& problem, const Frequencies& frequencies,
                                     const std::vector<double>& parameters) {
  const std::vector<double> here = frequencies.at(parameters);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    std::vector<double> moved = parameters;
    moved[i] += slightly * problem.reach(i);
    const std::vector<double> there = frequencies.at(moved);
    bool changes = there.size() != here.size();
    for (std::size_t k = 0; k < here.size() && !changes; ++k) {
      changes = std::abs(there[k] - here[k]) > slightly * slightly * here[k];
    }
    if (changes) out.push_back(i);
  }
  return out;
}

/// Finds parameters that have the frequencies of the minimum, from those with some of `changed` moved at random:
/// numbers that keep their sign by up to a factor, others by up to their reach.
std::optional<std::vector<double>> with_same_frequencies(const FitProblem& problem, const Frequencies& frequencies,
                                                         std::vector<double> parameters,
                                                         const std::vector<std::size_t>& changed,
                                                         std::uint64_t number) {
  solvers::RandomStream random(number);
  for (const std::size_t i : changed) {
    const Parameter& p = problem.parameters()[i];
    double& value = parameters[i];
    const bool keeps = random.uniform() < 0.5;
    const double by = random.uniform(-1, 1);
    if (keeps) continue;
    value = p.min >= 0 && value > 0 ? value * std::pow(far_factor, by) : value + problem.reach(i) * by;
    value = std::clamp(value, p.min, p.max);
  }
  std::vector<double> wanted;
  for (const Frequencies::Mode& mode : frequencies.modes()) wanted.push_back(mode.frequency);
  return frequencies.parameters_with(wanted, parameters);
}

/// Lists such parameters, the most likely first.
std::vector<Minimum> starts_with_other_states(const FitTask& task, const WeightedMinimum& at, const Fit& fitted) {
  std::vector<Minimum> out;
  if (!hides_states(task.problem)) return out;
  const FitPoint& point = at.minimum.point;
  const Frequencies frequencies(task.problem, point);
  const std::vector<std::size_t> changed = that_change(task.problem, frequencies, point.parameters);
  if (changed.empty()) return out;
  task.say("trying other parameters with the same frequencies");
  for (std::uint64_t k = 1; k <= most_far && !task.stopped(); ++k) {
    std::optional<std::vector<double>> parameters =
        with_same_frequencies(task.problem, frequencies, point.parameters, changed, k);
    if (!parameters || !differ(fitted, *parameters, point.parameters)) continue;
    out.push_back(with_following_nuisances(task, at.weighting, point, std::move(*parameters), frequencies));
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

std::vector<Minimum> minima_with_other_states(const FitTask& task, const WeightedMinimum& at, Fit& fitted,
                                              FitEffort& effort) {
  std::vector<Minimum> out;
  std::vector<std::vector<double>> tried;
  for (const Minimum& start : starts_with_other_states(task, at, fitted)) {
    if (task.stopped() || out.size() >= most_twins || !start.is_reached()) break;
    if (!effort.may_check()) {
      leave_out(fitted, "other minima");
      break;
    }
    const std::vector<double>& parameters = start.point.parameters;
    const auto same = [&](const std::vector<double>& one) { return !differ(fitted, one, parameters); };
    if (std::any_of(tried.begin(), tried.end(), same)) continue;
    tried.push_back(parameters);
    ++effort.tries;
    const Minimum found = minimise_as_check(task, at.weighting, start.point, effort);
    if (found.is_reached()) out.push_back({.cost = found.cost, .point = found.point});
  }
  return out;
}

std::vector<Minimum> minima_of_twins(const FitTask& task, const WeightedMinimum& at, Fit& fitted, FitEffort& effort) {
  std::vector<Minimum> out;
  for (const FitPoint& point : twins(task.problem, fitted)) {
    if (task.stopped() || out.size() >= most_twins) break;
    if (!effort.may_check()) {
      leave_out(fitted, "other minima");
      break;
    }
    task.say("trying other dimensions with which it moves alike");
    ++effort.tries;
    const Minimum found = minimise_as_check(task, at.weighting, point, effort);
    if (found.is_reached()) out.push_back({.cost = found.cost, .point = found.point});
  }
  return out;
}

void compare_with(const std::vector<Minimum>& others, const FitTask& task, const WeightedMinimum& at, Fit& fitted) {
  const FitProblem& problem = task.problem;
  const auto as_alternative = [&](const Minimum& minimum, double more) {
    return alternative_at(problem, minimum.point.parameters, Frequencies(problem, minimum.point), more);
  };
  std::vector<double> own;
  for (const Estimate& estimate : fitted.estimates) own.push_back(estimate.value);
  std::vector<Alternative> as_good;
  for (const Minimum& other : others) {
    const double more = more_than_best(task, other.cost, at.minimum.cost);
    if (!(std::abs(more) < equally_good)) continue;
    Alternative one = as_alternative(other, more);
    const auto same = [&](const Alternative& before) { return !differ(fitted, before.values, one.values); };
    if (!differ(fitted, own, one.values) || std::any_of(as_good.begin(), as_good.end(), same)) continue;
    as_good.push_back(std::move(one));
  }
  if (as_good.empty()) return;
  fitted.alternatives = {as_alternative(at.minimum, 0.0)};
  fitted.alternatives.insert(fitted.alternatives.end(), as_good.begin(), as_good.end());
  fitted.status = FitStatus::ambiguous;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < fitted.estimates.size(); ++i) {
    Estimate& estimate = fitted.estimates[i];
    const bool agrees = estimate.withheld || std::all_of(as_good.begin(), as_good.end(), [&](const Alternative& one) {
                          return std::abs(one.values[i] - estimate.value) <= agrees_within * estimate.standard_error;
                        });
    if (agrees) continue;
    estimate.withheld = true;
    estimate.why = "several minima";
    names.push_back(estimate.name);
  }
  fitted.why = fmt::format(
      "{} minima explain the readings equally well, with different values of {}; narrow min and max of the unknowns",
      fitted.alternatives.size(), fmt::join(names, ", "));
}

}  // namespace poise
