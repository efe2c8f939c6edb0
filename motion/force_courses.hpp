#pragma once

#include <string>
#include <vector>

#include "model/quantity.hpp"
#include "motion/forces_along.hpp"

namespace poise {

/// One number over all poses; SI.
struct ForceCourse {
  std::string name;
  Quantity quantity = Quantity::force;
  std::vector<double> value{};
  int element = -1;  ///< index in Scene::elements of the one whose force it is; -1 of all else
};

/// Every number: effort.DRIVE, power.DRIVE (energy per second), reaction.JOINT.x, .y, .moment, stop.NAME, blade.NAME
/// and the force elements, spring.NAME, torsion_damper.NAME, ... (tension, or moment on the second body), imbalance;
/// cam.NAME.pressure_angle, .normal_force, .side_thrust (statics/model/cam_contact.hpp), not a number without contact;
/// and overrun.NAME, angle or length, of a stop that some pose of a recorded motion has passed. Of joints with
/// friction, where something moves: effort_without_friction.DRIVE, where it was found, joint_friction.JOINT (against
/// its rate; where it stands still 0, or what holds it in a simulated motion) and lost.JOINT (energy per second). What
/// friction leaves without forces is not a number.
std::vector<ForceCourse> force_courses(const Scene& scene, const ForcesAlong& forces);

/// inertia.BODY.x, .y and .moment of every body with mass or a moment of inertia: -m a of its centre of mass, where it
/// acts, and -I alpha.
std::vector<ForceCourse> inertia_courses(const Scene& scene, const ForcesAlong& forces);

/// Joints with friction, and some pose moves.
bool rubs(const ForcesAlong& forces);

/// An element in parallel with a drive, and what it carries in every pose.
struct LoadedParallel {
  const Element& element;
  std::string drive;
  ForceCourse course;
};

/// Those that carry something in some pose, of the courses of the model's scene. The model must outlive them.
std::vector<LoadedParallel> loaded_parallels(const MotionModel& model, const std::vector<ForceCourse>& courses);

}  // namespace poise
