#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "motion/body_motion.hpp"

namespace poise {

/// A quantity that is driven: the absolute angle of a body, rad, or the travel of a slide or pin in a slot, m.
struct DriveRange {
  std::string name;  ///< of the body or joint
  double from = 0.0, to = 0.0;
};

/// What a name drives. Throws InputError, with the nearest name, where it is no body, slide or pin in a slot.
Drive find_drive(const Scene& scene, const std::string& name);

/// The first whose range has a length, which sets the pace of the others; the last where none has.
std::size_t first_moving(const std::vector<DriveRange>& ranges);

struct SweepOptions {
  int steps = 72;     ///< equal parts of the range: steps + 1 samples; one where no range has a length
  double rate = 1.0;  ///< of the first drive that moves, towards its end, rad/s or m/s; the others keep pace with it
  const std::atomic<bool>* interrupt = nullptr;
};

/// The mechanism at one place of the driven range. All SI.
struct KinematicSample {
  std::vector<double> drive;         ///< values of the driven quantities
  std::vector<double> q;             ///< coordinates
  std::vector<double> rate;          ///< dq/dt
  std::vector<double> acceleration;  ///< d2q/dt2, at drives without acceleration
  std::vector<BodyMotion> bodies;    ///< one per body of the scene
  double closeness_to_singular = 1;  ///< smallest over largest singular value of the closures with the drives held
};

/// A pose in which the drives do not decide how the mechanism moves.
struct SingularPose {
  enum class Kind {
    change_point,  ///< passed: another branch of motion crosses here
    dead_centre    ///< the end: the mechanism cannot be driven beyond
  };
  Kind kind = Kind::change_point;
  bool before_range = false;  ///< met on the way from the assembled start to the range
  std::vector<double> drive;  ///< values of the driven quantities
  std::vector<double> q;
  std::string text;  ///< "change point of the loop closed by \"D\": crank, coupler and rocker are in line"
};

/// A stop at which a range ends.
struct MetStop {
  std::size_t stop = 0;  ///< index into Scene::stops
  bool at_max = false;   ///< or at its min
};

/// How the mechanism moves over the range. Where the range cannot be completed the samples end at the stop that is met,
/// or before the dead centre, which is the last of `singular`.
struct KinematicsResult {
  bool complete = false;
  std::string why;                             ///< where not complete
  std::optional<MetStop> stop;                 ///< where a stop is why: it is met in the last sample, found to rounding
  std::vector<std::string> coordinates;        ///< names of q
  std::vector<bool> turns;                     ///< per body of the scene: whether it can turn
  std::vector<bool> is_angle;                  ///< which of q are angles; the others are lengths
  std::vector<std::size_t> drive_coordinates;  ///< the driven one of each drive
  std::vector<KinematicSample> samples;
  std::vector<SingularPose> singular;
};

/// Drives the mechanism from its assembled start to the begin of the range, and then along it. With d the driven
/// coordinates and f the others, at every pose of the path
///   c(f, d) = 0,   C_f f' = -C_d d',   C_f f'' = -C_d d'' - (C q')' q',
/// solved by rank-revealing factors, so that redundant closures do no harm. The path is followed by predictor and
/// corrector in steps short enough that a branch is never changed unseen; where C_f loses rank it is a singular pose,
/// whose place is found to about 1e-10. Derivatives there are the limits along the path. The range ends where a stop of
/// the scene would be passed, one more sample at the stop.
///
/// Throws InputError naming what else must be driven where the drives leave a freedom, where they contradict each
/// other, where a name is unknown, where the start cannot be assembled or is itself singular, and naming the stop that
/// would be passed on the way from the start to the range.
KinematicsResult sweep(const Scene& scene, const std::vector<DriveRange>& drives, const SweepOptions& options = {});

}  // namespace poise
