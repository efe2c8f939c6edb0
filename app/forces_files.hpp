#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/plot.hpp"
#include "app/quantity.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"

namespace poise::app {

/// What `poise forces` answers: forces in one pose, over a driven range, or along a motion.
struct ForcesAnswer {
  std::string how;                  ///< in words: "held where it stands", "driven at 1 rad/s", ...
  std::string along;                ///< what varies: the name of a drive, "time", or nothing
  std::optional<Quantity> measure;  ///< of it; none: seconds
  std::vector<double> at;           ///< its values, SI, one per pose; empty for a single pose
  std::vector<Forces> poses;
  double tolerance = 1e-9;      ///< imbalance over largest force, up to which a pose counts as balanced
  bool complete = true;         ///< the whole range could be driven
  std::string why;              ///< where not
  std::optional<MetStop> stop;  ///< where a stop is why: it is met in the last pose

  bool balanced() const;
};

/// One number over all poses; SI.
struct ForceCourse {
  std::string name;
  Quantity quantity = Quantity::force;
  std::vector<double> value;
};

/// Every number: effort.DRIVE, power.DRIVE (energy per second), reaction.JOINT.x, .y, .moment, stop.NAME and
/// the force elements, spring.NAME, torsion_damper.NAME, ... (tension, or moment on the second body), imbalance; and
/// overrun.NAME, angle or length, of a stop that some pose of a recorded motion has passed.
std::vector<ForceCourse> force_courses(const Scene& scene, const ForcesAnswer& answer);

/// The value of `along`, then force_courses, in the units of the scene, times in seconds.
std::string forces_csv(const Scene& scene, const ForcesAnswer& answer);

/// A JSON object: poise, scene {file, title, source, set}, units {...}, how, complete, why, stop (null, or {name,
/// limit: "min" or "max", value} of the stop that is met in the last pose and ends the range), balanced, along, at
/// [values], forces {NAME: [value per pose]} as force_courses, undetermined [names of reactions and drives that are
/// shared with others in some pose], idle_stops [names of stops that are touched in some pose where the drives carry
/// all], work_error, power_error (largest).
std::string forces_json(const MotionModel& model, const ForcesAnswer& answer, const std::vector<std::string>& settings);

/// An element in parallel with a drive, and what it carries in every pose.
struct LoadedParallel {
  const Element& element;
  std::string drive;
  ForceCourse course;
};

/// Those that carry something in some pose. The model must outlive them.
std::vector<LoadedParallel> loaded_parallels(const MotionModel& model, const ForcesAnswer& answer);

/// Charts over `along`: what drives give, and the size of the joints' reactions, at most twelve of them.
std::vector<Panel> forces_panels(const Scene& scene, const ForcesAnswer& answer);

}  // namespace poise::app
