#pragma once

#include <functional>
#include <string>
#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"

namespace poise {

/// The torque M of a drive over a period of its angle phi, at constant speed, and the energy that a flywheel must take
/// and give so that the torque of the motor is the mean: SI.
struct Fluctuation {
  /// A value and the angle at which it is reached, rad.
  struct Place {
    double angle = 0.0, value = 0.0;
  };

  std::string drive;
  double speed = 0.0;     ///< rad/s, its size
  Place least, greatest;  ///< of M
  double mean = 0.0;      ///< of M over the period
  double swing = 0.0;     ///< J: the largest less the least integral of (M - mean) dphi from the start of the period
  double fastest_at = 0.0, slowest_at = 0.0;  ///< angles at which that integral is least and largest
  /// Estimates of the errors of mean and swing: their changes from half as many poses to these.
  double mean_error = 0.0, swing_error = 0.0;
  int poses = 0;  ///< in which M was found

  /// The moment of inertia, on the axis of the drive, with which the speed stays within (largest - least) / mean =
  /// `coefficient`, to first order in it:  swing / (coefficient speed^2), kg m^2; and its error likewise.
  double flywheel(double coefficient) const { return swing / (coefficient * speed * speed); }
  double flywheel_error(double coefficient) const { return swing_error / (coefficient * speed * speed); }
};

/// Finds it over a period `from`..`to` of the angle, rad, from `torques(n)`: M at n + 1 angles with equal distances,
/// both ends included. By the trigonometric polynomial through these, which converges faster than any power of n where
/// M is smooth; n is doubled, from `least_poses` on, until the swing changes by less than 1e-9 of the largest torque
/// times the period, and the extremes, of the parabolas through three of the torques, by less than 1e-6 of it, or there
/// are `most_poses`. Throws InputError where a torque is undefined or M is not the same at
/// both ends.
Fluctuation fluctuation_of(const std::function<std::vector<double>(int)>& torques, double from, double to,
                           int least_poses, int most_poses);

/// That of the one drive of a model's scene, an angle, driven over a range at options.rate; options.steps is the least
/// number of poses. Throws InputError where the scene has other drives, where the range is not one of whole turns or
/// not driven to its end, and as forces_over().
Fluctuation fluctuation_over(const MotionModel& model, const DriveRange& range, const SweepOptions& options);

}  // namespace poise
