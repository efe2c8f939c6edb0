#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/quantity.hpp"
#include "motion/given_motion.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"

namespace poise {

/// Loads that follow functions of time are those of the pose's time, t = 0 in a single pose.
///
/// Forces in one pose, over a driven range, or along a motion; the drives are those of the model's scene.
struct ForcesAlong {
  std::string along;                ///< what varies: the name of a drive, "time", or nothing
  std::optional<Quantity> measure;  ///< of it; none: seconds
  std::vector<double> at;           ///< its values, SI, one per pose; empty for a single pose
  std::vector<Forces> poses;
  double tolerance = 1e-9;      ///< imbalance over largest force, up to which a pose counts as balanced
  bool complete = true;         ///< the whole range could be driven
  std::string why;              ///< where not
  std::optional<MetStop> stop;  ///< where a stop is why: it is met in the last pose
  /// Values of the drives, SI, at which is_dead_point(): of the single pose, or of the singular poses of the range,
  /// those at which it ends included.
  std::vector<std::vector<double>> dead_points;

  bool balanced() const;
};

/// Standing still where the scene's start and its drives put it. Throws InputError where that is beyond a stop.
ForcesAlong forces_in_place(const MotionModel& model);

/// Over a range; `ranges` are those of the scene's drives, in their order. Moving at options.rate, or standing still in
/// every pose. Throws InputError as sweep().
ForcesAlong forces_over(const MotionModel& model, const std::vector<DriveRange>& ranges, const SweepOptions& options,
                        bool moving);

/// Along a motion given at these times. Its accelerations are those of sampled rates or places, so that bodies balance
/// to the accuracy of the samples only: `tolerance` is 1e-6.
ForcesAlong forces_along(const MotionModel& model, const std::vector<double>& time, const GivenMotion& motion);

}  // namespace poise
