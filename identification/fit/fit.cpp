#include "identification/fit/fit.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <ceres/ceres.h>
#include <fmt/format.h>
#include <glog/logging.h>

#include "identification/fit/private/alternatives.hpp"
#include "identification/fit/private/curved_intervals.hpp"
#include "identification/fit/private/describe_fit.hpp"
#include "identification/fit/private/input_weights.hpp"
#include "identification/fit/private/linear_fit.hpp"
#include "identification/fit/private/noise_estimate.hpp"
#include "identification/fit/private/other_minima.hpp"
#include "identification/fit/private/run_influence.hpp"
#include "identification/fit/private/start_search.hpp"

namespace poise {
namespace {

/// Checks may take this part of a fit's own evaluations, and compute as many readings and derivatives of readings
/// however few these are.
constexpr double check_share = 0.2, least_check_work = 4e6;
/// How often a lower cost found beside the minimum leads to another one.
constexpr int most_improvements = 3;
/// A sum of squared residuals over the noise is lower where it is so by this.
constexpr double better_by = 1.0;

FitTask task_of(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options) {
  FitTask out{problem, records, options};
  for (const Record& record : records) out.readings += static_cast<int>(record.count());
  const auto parameters = static_cast<int>(problem.parameters().size() - options.held.size());
  out.sought = parameters + (options.holds_starts ? 0 : problem.nuisances());
  return out;
}

FoundMinimum first_minimum(const FitTask& task, const Weighting& weighting, FitEffort& effort) {
  if (task.degrees_of_freedom() <= 0) {
    FoundMinimum none;
    none.status = FitStatus::failed;
    none.why = fmt::format("{} readings do not determine {} values; add readings", task.readings, task.sought);
    return none;
  }
  return task.options.from != nullptr ? continue_fit(task, weighting, effort) : search_minimum(task, weighting, effort);
}

/// The noise to begin with: that of another fit, of one that this goes on from only where it is estimated.
Weighting first_weighting(const FitProblem& problem, const FitOptions& options) {
  if (options.from != nullptr) return options.from->weighting;
  Weighting out = problem.weighting();
  const Fit* const before = options.continued;
  for (std::size_t k = 0; before != nullptr && k < out.noise.size(); ++k) {
    const bool has = k < before->weighting.noise.size() && before->weighting.noise[k] > 0;
    if (has && estimates_noise(problem, out, k)) out.noise[k] = before->weighting.noise[k];
  }
  return out;
}

/// Minima beside the best one that have been found so far.
struct OtherMinima {
  std::optional<std::vector<Minimum>> states;  // of other states, and what was the best one before; not sought if none
  std::vector<Minimum> all;                    // these and twins of the best one
};

/// Finds a minimum with a lower cost than that of the fit, whose intervals are corrected on the way.
std::optional<Minimum> better_minimum(const FitTask& task, const WeightedMinimum& at, const LinearFit& linear,
                                      Fit& fitted, OtherMinima& others, FitEffort& effort) {
  if (!is_to_be_questioned(task, fitted)) return std::nullopt;
  if (auto better = correct_for_curvature(task, at, linear, fitted, effort)) return better;
  if (!others.states) others.states = minima_with_other_states(task, at, fitted, effort);
  others.all = *others.states;
  for (Minimum& twin : minima_of_twins(task, at, fitted, effort)) others.all.push_back(std::move(twin));
  if (others.all.empty()) return std::nullopt;
  Minimum least = *std::min_element(others.all.begin(), others.all.end());
  if (!(more_than_best(task, least.cost, at.minimum.cost) < -better_by)) return std::nullopt;
  const Minimum before{.cost = at.minimum.cost, .point = at.minimum.point};
  others.all.push_back(before);
  others.states->push_back(before);
  return least;
}

/// The evaluations that checks of a fit may take which took so many itself.
int most_checks(const FitTask& task, int own) {
  if (task.options.checks == Checks::all) return std::numeric_limits<int>::max();
  double numbers = 0.0;  // that one evaluation computes
  for (std::size_t r = 0; r < task.problem.runs(); ++r) {
    const RunModel& run = task.problem.run(r);
    numbers += static_cast<double>(run.readings(INFINITY)) * (1.0 + run.columns());
  }
  return static_cast<int>(std::max(check_share * own, least_check_work / std::max(1.0, numbers)));
}

/// Describes the fit at a minimum, or at a better one that it leads to.
Fit examined_fit(const FitTask& task, const FoundMinimum& found, WeightedMinimum at, FitEffort& effort) {
  effort.most_checks = most_checks(task, effort.evaluations);
  LinearFit linear = linearize(task, at.weighting, at.minimum);
  Fit out = describe_fit(task, found, at, linear, effort);
  OtherMinima others;
  for (int round = 0; round < most_improvements; ++round) {
    std::optional<Minimum> better = better_minimum(task, at, linear, out, others, effort);
    if (!better) break;
    at.minimum = std::move(*better);
    linear = linearize(task, at.weighting, at.minimum);
    out = describe_fit(task, found, at, linear, effort);
  }
  set_effort(out, effort);
  compare_with(others.all, task, at, out);
  if (is_to_be_questioned(task, out)) {
    examine_runs(task.problem, task.records, linear.runs, task.options, effort.most_checks, out);
  }
  if (task.options.checks == Checks::none && task.options.from == nullptr) {
    out.unexamined = {"the cost away from the minimum", "other minima", "fits without a run"};
  }
  return out;
}

}  // namespace

std::string to_string(FitStatus status) {
  switch (status) {
    case FitStatus::not_run:
      return "not run";
    case FitStatus::converged:
      return "converged";
    case FitStatus::misfit:
      return "misfit";
    case FitStatus::ambiguous:
      return "ambiguous";
    case FitStatus::failed:
      return "failed";
    case FitStatus::interrupted:
      return "interrupted";
  }
  return "";
}

Fit fit(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options) {
  const auto begun = std::chrono::steady_clock::now();
  const FitTask task = task_of(problem, records, options);
  FitEffort effort;
  const Weighting weighting = first_weighting(problem, options);
  FoundMinimum found = first_minimum(task, weighting, effort);
  WeightedMinimum at{std::move(found.best), weighting};
  Fit out;
  if (options.values_only || !at.minimum.is_reached()) {
    out = values_of_fit(task, found, at, effort);
  } else {
    if (options.from == nullptr) at = estimate_noise(task, std::move(at), effort);
    if (at.weighting.inputs.empty()) at = weigh_by_input_errors(task, std::move(at), effort);
    out = examined_fit(task, found, std::move(at), effort);
  }
  if (task.stopped() && out.usable()) {
    out.status = FitStatus::interrupted;
    out.why = "interrupted while the minimum was examined; its values are shown";
  }
  const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - begun;
  out.microseconds = took.count();
  return out;
}

void quiet_ceres() { FLAGS_minloglevel = google::GLOG_FATAL; }

}  // namespace poise
