#pragma once

// Measures by vector mechanics, from the poses of the bodies: for the independent checks, which use none of the phasor
// sums that the mechanism is compiled to.

#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise {

/// Value of a measure, rad or m, with the scene's bodies at `poses`, SI, measured from any point of the world; the
/// ground's origin says from which.
double value_of(const Scene& scene, const Measure& measure, const std::vector<BodyPose<double>>& poses);

/// Loads that correspond to a unit effort (1 N, or 1 N m on an angle) on a measure: `force`, N per unit, and `moment`,
/// N m per unit, on body b at the point b, measured as the poses, their opposites on body a at the point a. Their power
/// is the rate of the measure. A distance of zero has no direction, and no force.
struct UnitEffort {
  int body_a = 0, body_b = 0;
  Vec2 a{}, b{};
  Vec2 force{};
  double moment = 0.0;
};

/// One unit effort, or for a sum one per term.
std::vector<UnitEffort> unit_efforts(const Scene& scene, const Measure& measure,
                                     const std::vector<BodyPose<double>>& poses);

}  // namespace poise
