#pragma once

#include <functional>
#include <limits>
#include <vector>

#include "motion/reduced_motion.hpp"

namespace poise {

/// A state (t, z, w) of a mechanism and accelerations that it might have, of its independent coordinates, drawn at
/// random; in the units of the scaled scene.
struct RandomState {
  double t = 0.0;
  std::vector<double> z, w, alpha;
};

/// Places `reduced` in up to `states` poses reached from the closed pose x, without dead points, and calls `visit` with
/// each of them; rates and accelerations are between -1 and 1, times between 0 and `duration`. The same poses in every
/// call. Coordinates must have been chosen.
void visit_random_states(ReducedMotion<double>& reduced, const std::vector<double>& x, int states, double duration,
                         const std::function<void(const RandomState&)>& visit);

/// Relative change of the scene's numbers that shows what their rounding, and that of all computation, may do.
inline constexpr double disturbance = 4 * std::numeric_limits<double>::epsilon();
/// A scene in which every number that a motion depends on is changed at random by a relative `disturbance` at most.
Scene disturbed(Scene scene);

}  // namespace poise
