#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "motion/body_motion.hpp"

namespace poise {

/// A measure that is driven, rad or m.
struct DriveRange {
  std::string name;  ///< as find_drive() reads it
  double from = 0.0, to = 0.0;
  std::optional<Measure> on{};  ///< what is driven; absent: what the name says
};

/// The drive of a measure by its name (model/named_measures.hpp): "crank", the angle of a body in the world, "ram", the
/// travel of a slide, "length.shock", "angle.upper.lower", "x.ram.C". Throws InputError, with the nearest name, where
/// there is none.
Drive find_drive(const Scene& scene, const std::string& name);
/// What that is: "angle of crank in the world". Throws InputError in the same way.
std::string drive_in_words(const Scene& scene, const std::string& name);

/// The first whose range has a length, which sets the pace of the others; the last where none has.
std::size_t first_moving(const std::vector<DriveRange>& ranges);

struct SweepOptions {
  int steps = 72;            ///< equal parts of the range: steps + 1 samples; one if no range has a length
  std::vector<double> at{};  ///< in place of equal parts: the samples as shares of the range, which ascend in 0 .. 1
  /// Steps that are tried at most from the start to the range, and over the range. A way that needs more in any case is
  /// refused before the first.
  int most_steps = 200'000;
  double rate = 1.0;  ///< of the first drive that moves, towards its end, rad/s or m/s; the others keep pace with it
  const std::atomic<bool>* interrupt = nullptr;
};

/// The mechanism at one point of the driven range. All SI.
struct KinematicSample {
  std::vector<double> drive;         ///< values of the driven measures
  std::vector<double> drive_rate;    ///< their derivatives by time
  std::vector<double> q;             ///< coordinates
  std::vector<double> rate;          ///< dq/dt
  std::vector<double> acceleration;  ///< d2q/dt2, at drives without acceleration
  std::vector<BodyMotion> bodies;    ///< one per body of the scene
  double closeness_to_singular = 1;  ///< smallest over largest singular value of the closures with the drives held
};

/// A pose in which the drives do not determine the motion of the mechanism.
struct SingularPose {
  enum class Kind {
    change_point,  ///< bifurcation of motion, passed: another branch crosses here
    dead_centre    ///< the end: the mechanism cannot be driven beyond
  };
  Kind kind = Kind::change_point;
  bool before_range = false;  ///< on the way from the assembled start to the range
  std::vector<double> drive;  ///< values of the driven measures
  std::vector<double> q;
  std::string text;  ///< "change point of the loop closed by \"D\": crank, coupler and rocker are in line"
};

/// A stop at which a range ends.
struct MetStop {
  std::size_t stop = 0;  ///< index into Scene::stops
  bool at_max = false;   ///< or at its min
};

/// Motion of the mechanism over the range. If the range cannot be completed the samples end at the stop that is
/// reached, or before the dead centre, which is the last of `singular`.
struct KinematicsResult {
  bool complete = false;
  std::string why;                       ///< if not complete
  std::optional<MetStop> stop;           ///< if a stop ends the range: reached in the last sample, found to rounding
  std::vector<std::string> coordinates;  ///< names of q
  std::vector<bool> turns;               ///< per body of the scene: whether it can turn
  std::vector<bool> is_angle;            ///< which of q are angles; the others are lengths
  std::vector<KinematicSample> samples;
  std::vector<SingularPose> singular;
};

/// Drives the mechanism from its assembled start to the beginning of the range, and then along it. With d the driven
/// coordinates and f the others, at every pose of the path
///   c(f, d) = 0,   C_f f' = -C_d d',   C_f f'' = -C_d d'' - (C q')' q',
/// where a driven measure m that is no coordinate is made one: c has the row m(q) - d = 0 more, and f all of q. They
/// are solved by rank-revealing factorization, so that redundant closures are admissible. The path is followed by
/// predictor and corrector in steps short enough that the branch does not change unnoticed; a pose where C_f loses rank
/// is singular, and is located to about 1e-10. Derivatives there are the limits along the path. The range ends where a
/// stop of the scene would be passed, with one more sample at the stop.
///
/// Throws InputError if the drives leave a degree of freedom, naming what else must be driven, if they contradict each
/// other, if a name is unknown, if a way is farther than its steps can lead, if the start cannot be assembled or is
/// itself singular, and if a stop, named, would be passed on the way from the start to the range.
KinematicsResult sweep(const Scene& scene, const std::vector<DriveRange>& drives, const SweepOptions& options = {});

}  // namespace poise
