#pragma once

// Mechanics of a scene from the places of its bodies alone: what the phasor form is compared with.

#include <vector>

#include "model/mechanism.hpp"
#include "model/scene.hpp"

namespace poise::test {

/// Places of bodies (and of bars behind them, as Mechanism::poses() gives them), SI.
using Poses = std::vector<BodyPose<double>>;

/// World coordinates of a point, m.
Vec2 world(const Scene& scene, PointRef p, const Poses& poses);

/// Potential of dead loads, gravity, springs and constant forces upon measures g, J:
///   V = - sum F . p - sum torque angle - sum m g . p_center + sum k/2 (g - g0)^2 + sum T g.
/// Follower forces have none and are left out.
double potential_energy(const Scene& scene, const Poses& poses);

/// Gap of a joint, m: p_b - p_a without the travel along its axis, `travel`. The gap of a bar is the sum of the gaps
/// at its two ends; its place follows those of the bodies in the order of the joints.
Vec2 gap(const Scene& scene, int joint, double travel, const Poses& poses);

/// The measure, rad or m.
double measured(const Scene& scene, const Measure& measure, const Poses& poses);

}  // namespace poise::test
