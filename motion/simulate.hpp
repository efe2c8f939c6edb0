#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/trajectory.hpp"

namespace poise {

/// Where a motion begins: closed coordinates q and rates v, SI, n values each. Only the rates of the independent
/// coordinates count, the others follow.
struct MotionState {
  std::vector<double> q, v;
};

/// A coordinate, or its rate, that a motion is to begin with.
struct StartValue {
  int coordinate = 0;  ///< of the model's layout, < kept
  bool rate = false;
  double value = 0.0;  ///< SI, absolute
};

/// Closes the loops of the scene's start, or takes the closed `q` (SI), and moves on to the values wanted, all other
/// freedoms changing as little as they can; rates not wanted are zero. Throws InputError where the loops cannot be
/// closed there, or the values contradict each other.
MotionState start_motion(const MotionModel& model, const std::vector<StartValue>& wanted,
                         const std::vector<double>* q = nullptr);

struct MotionOptions {
  double duration = 1.0;  ///< s
  /// Relative to how far each coordinate travels and how fast it goes: steps keep their error estimate below a
  /// thousandth of it, and what they read between their ends below itself.
  double accuracy = 1e-10;
  /// Sensitivities wanted: of the f initial independent coordinates, the f initial independent rates, then these.
  bool sensitivities = false;
  /// Independent coordinates to begin with, where these are to be the same in several motions; empty: chosen.
  std::vector<int> independent{};
  std::vector<Influence> influences{};  ///< in the units of the scaled scene, per unit of the caller's number
  int most_steps = 10'000'000;
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(double)> progress{};  ///< told the time reached, at every step
};

enum class MotionStatus {
  not_started,
  completed,
  interrupted,
  stuck,       ///< no step led on: a dead centre, or loops that open
  no_inertia,  ///< a freedom has no inertia
  step_limit
};

std::string to_string(MotionStatus status);

/// A motion, as far as it came.
struct Motion {
  MotionStatus status = MotionStatus::not_started;
  std::string why;  ///< one sentence where it did not complete
  Trajectory trajectory;
  std::vector<int> independent;                  ///< coordinates whose start values the sensitivities refer to
  std::vector<double> kinetic, potential, work;  ///< per node, J; work: done by drives, follower loads, resistances
  std::vector<std::vector<double>> drive_force;  ///< per drive, per node: N m or N
  double energy_error = 0.0;  ///< largest |T + V - work - (T + V at start)| / largest energy exchanged; 0 at rest
  int freedoms = 0;
  int steps = 0, rejected = 0, evaluations = 0;
  double microseconds = 0.0;
  std::vector<double> singular;      ///< times at which it passed a singular pose, to about a hundredth of a step
  std::vector<std::string> overrun;  ///< stops that it ran through: stops do not act in motion

  bool completed() const { return status == MotionStatus::completed; }
};

/// Moves the mechanism from `start` under all its forces and drives: the reduced equations of ReducedMotion by
/// RungeKutta78, loops closed at every stage, coordinates chosen anew where they serve badly.
Motion simulate(const MotionModel& model, const MotionState& start, const MotionOptions& options);

/// The largest difference of two motions of one start, relative to how far each coordinate travels: with one of them
/// at a stricter accuracy, the error of the other.
double difference(const Motion& a, const Motion& b);

}  // namespace poise
