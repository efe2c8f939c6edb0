#pragma once

#include <vector>

#include "statics/model/static_model.hpp"

namespace poise::test {

/// The heavily damped motion in fixed small steps, each followed by closing the loops: slow, and simple enough to be
/// believed. Dense matrices, the identity as resistance against scaled coordinates.
struct SlowMotion {
  enum class End { rest, far, steps };
  End end = End::steps;
  std::vector<double> x;
};

/// One freedom: steps of length `step` along the tangent on which the force has a positive component, until it turns
/// back, a stop is reached or the start is `far` away.
SlowMotion slow_motion_along_curve(const StaticModel& model, const std::vector<double>& x, double step, double far);

/// Several freedoms: steps of `part` over the largest curvature of the energy, by the midpoint rule, until it is within
/// `near` of `goal`, nearly at rest, or `far` away. Stops: the velocity nearest to the force that leads into none.
SlowMotion slow_motion(const StaticModel& model, const std::vector<double>& x, const std::vector<double>& goal,
                       double part, double near, double far, int most_steps);

}  // namespace poise::test
