#pragma once

#include <array>
#include <string>
#include <vector>

// A fit of double pendulums as one writes it without Poise: equations by hand, Runge and Kutta's method at fixed steps,
// dual numbers, Ceres. All SI.

namespace poise::benchmarks {

/// What the bare program knows of a double pendulum, by place.
enum PendulumNumber {
  inertia_1,  ///< about the centre of mass
  inertia_2,
  center_1,    ///< from the shoulder, along the arm
  center_2_x,  ///< from the elbow, along the arm and across it
  center_2_y,
  length,  ///< from the shoulder to the elbow
  damping_1,
  damping_2,  ///< of the elbow
  dry_1,
  dry_2,  ///< torque of dry friction in the elbow:  dry tanh(rate / width)
  pendulum_numbers
};

struct PendulumRig {
  double mass_1 = 0.0, mass_2 = 0.0;
  double gravity = 0.0;
  double gear = 1.0;   ///< turns of the motor per turn of the first arm, on whose shaft the torque acts
  double rotor = 0.0;  ///< inertia of the motor
  double width = 0.0;  ///< of the dry friction, rad/s
  /// The dry friction is larger at rest by this part of its size: it falls as  1 + fall / (1 + rate / fall_rate).
  double fall = 0.0, fall_rate = 1.0;
};

/// Readings at the times  0, step, 2 step, ...: angles of both arms from the horizontal, torque on the motor, which
/// straight lines join; none where nothing drives it.
struct PendulumRecord {
  double step = 0.0;
  std::vector<double> angle_1, angle_2, torque;
};

using PendulumValues = std::array<double, pendulum_numbers>;
using PendulumState = std::array<double, 4>;  ///< angles, then rates

/// Replaces the readings of a record by those of a motion from this state, with steps of a hundredth of a millisecond.
void move_pendulum(const PendulumRig& rig, const PendulumValues& numbers, const PendulumState& start,
                   PendulumRecord& record);

struct PendulumFit {
  PendulumValues numbers{};
  double rms = 0.0;  ///< of all angles, rad
  int iterations = 0;
  bool converged = false;
};

/// Fits `unknowns` and the start of each record, from `numbers` and `starts`, by Ceres: dual numbers, steps of 1 ms,
/// one thread, bounds of 0 for damping and friction. There may be 7, 8 or 9 unknowns.
PendulumFit fit_pendulum(const PendulumRig& rig, const std::vector<PendulumRecord>& records,
                         const std::vector<PendulumNumber>& unknowns, const PendulumValues& numbers,
                         const std::vector<PendulumState>& starts);

}  // namespace poise::benchmarks
