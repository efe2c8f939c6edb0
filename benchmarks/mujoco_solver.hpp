#pragma once

#include <memory>

#include "benchmarks/plain_mechanism.hpp"

namespace poise::benchmarks {

/// The mechanism as a MuJoCo model, made from MJCF text: a tree of hinges and slides, "connect" equalities where loops
/// close, tendons for springs and for the limits of stops. Dead loads, and springs that act one way, which MuJoCo 2.2
/// has not, are passive forces. As bodies may have no mass, every joint has an armature and a damper. Two methods:
///
///   0  mj_step from rest until velocities and accelerations are below the accuracy. Closures are as stiff as the step
///   h
///      lets them be (stiffness 1 / h^2, damping 1 / h, impedance 0.9999), stops a quarter of it; what they give is in
///      proportion to h^2, so that h follows from the accuracy.
///   1  Newton on the accelerations of mj_forward at rest, with derivatives by differences: closures as springs of
///      stiffness `newton_stiffness`, which no step bounds. Accuracy is that of the last step.
///
/// Throws std::invalid_argument where a body is not tied to the ground by pins and slides that lead away from it,
/// another joint than a pin closes a loop, or MuJoCo refuses the model.
std::unique_ptr<PlainSolver> mujoco_solver(const PlainMechanism& mechanism);

}  // namespace poise::benchmarks
