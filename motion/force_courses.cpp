#include "motion/force_courses.hpp"

#include <algorithm>
#include <limits>

#include "model/controllers.hpp"
#include "motion/blades.hpp"
#include "statics/model/cam_contact.hpp"

namespace poise {
namespace {

/// What a stop carries in one pose: 0 where it is not in contact.
double stop_force(const Scene& scene, std::size_t stop, const Forces& forces) {
  const Reaction* const reaction = reaction_of_stop(forces.reactions, stop);
  if (reaction == nullptr) return 0.0;
  return scene.stops[stop].on.is_angle() ? reaction->moment : reaction->axial;
}

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

/// The friction of a joint; null where it stands still or has none.
const SlidingJoint* sliding(const Forces& forces, int joint) {
  for (const SlidingJoint& one : forces.friction.joints) {
    if (one.joint == joint) return &one;
  }
  return nullptr;
}

/// Contacts of cams in all poses.
void add_cams(std::vector<ForceCourse>& out, const Scene& scene, const ForcesAlong& forces) {
  std::vector<std::vector<CamReading>> cams;
  for (const Forces& pose : forces.poses) {
    cams.push_back(cam_readings(scene, poses_of(pose.motions), pose.reactions));
    if (!pose.friction.has_no_forces()) continue;
    for (CamReading& cam : cams.back()) cam.contact.reset();
  }
  const auto add = [&](std::size_t k, const std::string& what, Quantity quantity, double CamContact::*number) {
    ForceCourse course{"cam." + cams.front()[k].name + what, quantity};
    for (const std::vector<CamReading>& pose : cams) {
      course.value.push_back(pose[k].contact ? (*pose[k].contact).*number : std::numeric_limits<double>::quiet_NaN());
    }
    out.push_back(std::move(course));
  };
  for (std::size_t k = 0; k < cams.front().size(); ++k) {
    add(k, ".pressure_angle", Quantity::angle, &CamContact::pressure_angle);
    add(k, ".normal_force", Quantity::force, &CamContact::normal);
    add(k, ".side_thrust", Quantity::force, &CamContact::side);
  }
}

}  // namespace

bool rubs(const ForcesAlong& forces) {
  return std::any_of(forces.poses.begin(), forces.poses.end(), [](const Forces& f) {
    return f.friction.state != SlidingFriction::State::none && f.friction.state != SlidingFriction::State::still;
  });
}

std::vector<ForceCourse> force_courses(const Scene& scene, const ForcesAlong& forces) {
  std::vector<ForceCourse> out;
  const auto add = [&](const std::string& name, Quantity quantity, auto value) {
    ForceCourse course{name, quantity};
    for (const Forces& pose : forces.poses) course.value.push_back(value(pose));
    out.push_back(std::move(course));
  };
  // Of what depends on friction.
  const auto add_force = [&](const std::string& name, Quantity quantity, auto value) {
    add(name, quantity, [&](const Forces& f) { return f.friction.has_no_forces() ? no_number : value(f); });
  };
  if (forces.poses.empty()) return out;
  const std::vector<DriveEffort>& drives = forces.poses.front().drives;
  for (std::size_t k = 0; k < drives.size(); ++k) {
    add_force("effort." + drives[k].name, drives[k].is_angle ? Quantity::moment : Quantity::force,
              [k](const Forces& f) { return f.drives[k].value; });
    add_force("power." + drives[k].name, Quantity::energy, [k](const Forces& f) { return f.drives[k].power; });
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const std::string name = "reaction." + scene.joints[j].name;
    add_force(name + ".x", Quantity::force, [j](const Forces& f) { return f.reactions[j].force.x; });
    add_force(name + ".y", Quantity::force, [j](const Forces& f) { return f.reactions[j].force.y; });
    if (!scene.joints[j].keeps_angle()) continue;
    add_force(name + ".moment", Quantity::moment, [j](const Forces& f) { return f.reactions[j].moment; });
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    add_force("stop." + scene.stops[s].name, effort_of(scene.stops[s].on),
              [&scene, s](const Forces& f) { return stop_force(scene, s, f); });
  }
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (!scene.stops[s].friction) continue;
    add_force("stop_friction." + scene.stops[s].name, Quantity::force, [s](const Forces& f) {
      for (const SlidingStop& one : f.friction.stops) {
        if (one.stop == static_cast<int>(s)) return one.effort;
      }
      return 0.0;
    });
  }
  for (std::size_t b = 0; b < scene.blades.size(); ++b) {
    add_force("blade." + scene.blades[b].name, Quantity::force,
              [&scene, b](const Forces& f) { return blade_force(scene, b, f); });
  }
  // Elements that stand for the friction of joints and stops in a scene in motion have no forces of their own.
  const std::size_t elements = std::min(scene.elements.size(), forces.poses.front().element_force.size());
  for (std::size_t i = 0; i < elements; ++i) {
    const Element& element = scene.elements[i];
    if (element.feedback && !element.feedback->acts) continue;  // what it gives is no force
    const double sign = element.on.is_angle() ? -1.0 : 1.0;
    add(element.table + "." + element.name, effort_of(element.on),
        [i, sign](const Forces& f) { return sign * f.element_force[i]; });
    out.back().element = static_cast<int>(i);
  }
  add_cams(out, scene, forces);
  if (rubs(forces)) {
    const bool is_known = std::all_of(forces.poses.begin(), forces.poses.end(), [&](const Forces& f) {
      return f.friction.efforts_without.size() == drives.size();
    });
    for (std::size_t k = 0; is_known && k < drives.size(); ++k) {
      add("effort_without_friction." + drives[k].name, drives[k].is_angle ? Quantity::moment : Quantity::force,
          [k](const Forces& f) { return f.friction.efforts_without[k]; });
    }
    for (std::size_t j = 0; j < scene.joints.size(); ++j) {
      const Joint& joint = scene.joints[j];
      if (!joint.friction) continue;
      const int index = static_cast<int>(j);
      add_force("joint_friction." + joint.name, joint.has_travel() ? Quantity::force : Quantity::moment,
                [index](const Forces& f) {
                  const SlidingJoint* const one = sliding(f, index);
                  return one != nullptr ? one->effort : 0.0;
                });
      add_force("lost." + joint.name, Quantity::energy, [index](const Forces& f) {
        const SlidingJoint* const one = sliding(f, index);
        return one != nullptr ? one->lost() : 0.0;
      });
    }
  }
  add("imbalance", Quantity::force, [](const Forces& f) { return f.imbalance; });
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    if (std::none_of(forces.poses.begin(), forces.poses.end(), [s](const Forces& f) { return f.overrun[s] > 0.0; })) {
      continue;
    }
    add("overrun." + scene.stops[s].name, quantity_of(scene.stops[s].on),
        [s](const Forces& f) { return f.overrun[s]; });
  }
  return out;
}

std::vector<ForceCourse> inertia_courses(const Scene& scene, const ForcesAlong& forces) {
  const std::set<int> states = bodies_of_states(scene);
  std::vector<ForceCourse> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    const auto add = [&](const char* part, Quantity quantity, auto value) {
      ForceCourse course{"inertia." + body.name + part, quantity};
      for (const Forces& pose : forces.poses) course.value.push_back(value(pose.motions[i]));
      out.push_back(std::move(course));
    };
    if (body.mass > 0.0) {
      add(".x", Quantity::force, [&](const BodyMotion& m) { return -body.mass * m.acceleration_of(body.center).x; });
      add(".y", Quantity::force, [&](const BodyMotion& m) { return -body.mass * m.acceleration_of(body.center).y; });
    }
    if (body.inertia > 0.0 && !states.contains(static_cast<int>(i))) {
      add(".moment", Quantity::moment, [&](const BodyMotion& m) { return -body.inertia * m.angular_acceleration; });
    }
  }
  return out;
}

std::vector<LoadedParallel> loaded_parallels(const MotionModel& model, const std::vector<ForceCourse>& courses) {
  std::vector<LoadedParallel> out;
  for (const ParallelElement& parallel : parallel_elements(model, model.scene().drives)) {
    const auto index = static_cast<int>(parallel.element);
    const auto course =
        std::find_if(courses.begin(), courses.end(), [&](const ForceCourse& c) { return c.element == index; });
    if (course == courses.end()) continue;
    if (std::any_of(course->value.begin(), course->value.end(), [](double v) { return v != 0.0; })) {
      out.push_back({model.scene().elements[parallel.element], parallel.drive, *course});
    }
  }
  return out;
}

}  // namespace poise
