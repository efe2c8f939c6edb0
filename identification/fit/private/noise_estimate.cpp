#include "identification/fit/private/noise_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "identification/fit/private/linear_fit.hpp"

namespace poise {
namespace {

/// Rounds of the estimate, and the relative change of the noise at which they end.
constexpr int most_noise_rounds = 30;
constexpr double noise_is_found = 1e-3;

}  // namespace

bool estimates_noise(const FitProblem& problem, const Weighting& weighting, std::size_t sensor) {
  return !problem.experiment().sensors[sensor].noise_known || weighting.loss == Loss::student;
}

WeightedMinimum estimate_noise(const FitTask& task, WeightedMinimum from, FitEffort& effort) {
  WeightedMinimum out = std::move(from);
  std::vector<double>& noise = out.weighting.noise;
  bool any = false;
  for (std::size_t k = 0; k < noise.size(); ++k) any = any || estimates_noise(task.problem, out.weighting, k);
  for (int round = 0; any && round < most_noise_rounds && !task.stopped(); ++round) {
    task.say(fmt::format("estimating the noise of the sensors, round {}", round + 1));
    const StandardErrors errors = linearize(task, out.weighting, out.minimum).errors;
    if (errors.sensors.empty()) break;
    double change = 0.0;
    for (std::size_t k = 0; k < noise.size(); ++k) {
      const double ratio = errors.sensors[k].ratio;
      if (!estimates_noise(task.problem, out.weighting, k) || !(ratio > 0)) continue;
      noise[k] *= ratio;
      change = std::max(change, std::abs(ratio - 1));
    }
    Minimum next = minimise(task, out.weighting, out.minimum.point, 1.0, effort);
    if (!next.is_reached()) break;
    out.minimum = std::move(next);
    if (change < noise_is_found) break;
  }
  return out;
}

}  // namespace poise
