#include "identification/fit/private/curved_intervals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/curvature.hpp"
#include "identification/fit/private/describe_fit.hpp"

namespace poise {
namespace {

/// An interval that is longer by this part of it is said to be.
constexpr double nearly_straight = 0.1;

void widen(const FitProblem& problem, std::size_t i, double low, double high, Fit& fitted) {
  Estimate& estimate = fitted.estimates[i];
  const double reach = fitted.errors.reach[i];
  const double longer = std::max({reach, estimate.value - low, high - estimate.value});
  estimate.low = std::min(estimate.low, low);
  estimate.high = std::max(estimate.high, high);
  if (longer <= (1 + nearly_straight) * reach) return;
  estimate.is_curved = true;
  estimate.standard_error = fitted.errors.error[i] * longer / reach;
  const FitProblem::Scale scale = problem.scale_of(i, estimate.value);
  const bool large = scale.size > 0 && estimate.standard_error > scale.size / identifiable_from;
  estimate.poorly_determined = large;
  if (large && scale.is_own_size && !estimate.withheld) withhold(fitted, i, "not identifiable from these data");
}

/// The minimum near a fit with a lower cost.
Minimum minimum_near(const FitTask& task, const Weighting& weighting, const Fit& better, FitEffort& effort) {
  Minimum out{.cost = better.cost, .point = {better.parameters, {}}};
  for (const RunFit& run : better.runs) out.point.nuisances.push_back(run.nuisances);
  Minimum lower = minimise_as_check(task, weighting, out.point, effort);
  return lower.cost <= out.cost ? lower : out;
}

}  // namespace

bool is_to_be_questioned(const FitTask& task, const Fit& fitted) {
  return fitted.usable() && fitted.identifiability.ok && task.options.from == nullptr &&
         task.options.checks != Checks::none && !task.stopped();
}

std::optional<Minimum> correct_for_curvature(const FitTask& task, const WeightedMinimum& at, const LinearFit& linear,
                                             Fit& fitted, FitEffort& effort) {
  Curvature found = find_curvature(task.problem, task.records, fitted, linear.runs, task.options,
                                   effort.most_checks - effort.check_evaluations);
  effort.check_evaluations += found.evaluations;
  if (!found.is_complete) leave_out(fitted, "the cost away from the minimum");
  if (found.better) return minimum_near(task, at.weighting, *found.better, effort);
  fitted.traces = std::move(found.traces);
  for (std::size_t i = 0; i < fitted.estimates.size(); ++i) {
    if (std::isnan(found.low[i])) continue;
    const double includes = task.problem.unknown_of(i).includes;
    widen(task.problem, i, found.low[i] + includes, found.high[i] + includes, fitted);
    if (found.open[i] == 0 || fitted.estimates[i].withheld) continue;
    withhold(fitted, i,
             fmt::format("not identifiable from these data: the cost grows {:.2g} times slower than the parabola "
                         "at its minimum",
                         found.open[i]));
  }
  return std::nullopt;
}

}  // namespace poise
