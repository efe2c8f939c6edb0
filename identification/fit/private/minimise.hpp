#pragma once

// The descent from one start to a minimum of the cost.

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "identification/fit/private/fit_task.hpp"
#include "identification/identifiability/frequencies.hpp"

namespace poise {

/// A minimum of the cost, or a point at which one may be near.
struct Minimum {
  double cost = INFINITY;  ///< half the sum of rho over all residuals and priors; infinite where it is not known
  FitPoint point;
  /// The runs linearized at the point, as far as the descent computed them there last.
  std::vector<std::optional<LinearRun>> computed{};
  std::string why_not{};  ///< one sentence where the descent failed

  bool is_reached() const { return cost < INFINITY; }
  bool operator<(const Minimum& other) const { return cost < other.cost; }
};

/// Descends from `start` by Ceres (Levenberg-Marquardt within the ranges), over the readings of the first part
/// `window` of every record. With less than the whole, 1, the result is only a start for more readings: it is less
/// accurate, and its cost is that of these readings. Where the descent fails the point is the start.
Minimum minimise(const FitTask& task, const Weighting& weighting, const FitPoint& start, double window,
                 FitEffort& effort);

/// Does the same over the whole records, to put a minimum in question: its evaluations count as those of checks.
Minimum minimise_as_check(const FitTask& task, const Weighting& weighting, const FitPoint& start, FitEffort& effort);

}  // namespace poise
