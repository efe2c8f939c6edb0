#include "motion/loads_in_motion.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "solvers/not_a_number.hpp"

namespace poise {
namespace {

/// Of a motion whose start alone is asked for.
constexpr double any_duration = 1e-6;

}  // namespace

ForcesInMotion in_motion(const Scene& scene, const Forces& forces) {
  ForcesInMotion out{
      .element_forces = forces.element_force, .reactions = forces.reactions, .efforts = {}, .accelerations = {}};
  for (std::size_t k = 0; k < forces.drives.size(); ++k) {
    out.efforts.push_back({forces.drives[k].name, scene.drives[k].on, forces.drives[k].value});
  }
  for (const SlidingJoint& one : forces.friction.joints) {
    out.efforts.push_back({scene.joints[static_cast<std::size_t>(one.joint)].name, one.on, one.effort});
  }
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodyMotion& motion = forces.motions[i];
    out.accelerations.push_back({motion.acceleration, motion.rate, motion.angular_acceleration});
  }
  return out;
}

QuantityValue load_in_link(const SoughtQuantity& of, const Scene& scene, const std::vector<LinkLoads>& links) {
  const auto item = static_cast<std::size_t>(of.item);
  const std::string& name = of.other < 0 ? scene.bodies[item].name : scene.flexible_links[item].name;
  const auto none = [](std::string why) { return QuantityValue{not_a_number, std::move(why)}; };
  const auto link = std::find_if(links.begin(), links.end(), [&](const LinkLoads& one) { return one.name == name; });
  if (link == links.end()) return none("it has no section");
  if (!link->why.empty()) return none(link->why);
  if (of.kind == SoughtQuantity::Kind::stress) return {link->stress(), ""};
  const std::optional<LinkState> state = link->at_nearest(scene.local(of.point));
  if (!state) return none("its line has no pieces");
  const bool is_moment = of.part == SoughtQuantity::Part::moment;
  const bool is_shear = of.part == SoughtQuantity::Part::shear;
  return {is_moment ? state->moment : is_shear ? state->shear : state->normal, ""};
}

LoadsInMotion loads_in_motion(const MotionModel& model, const MotionState& start, double time, MotionOptions options) {
  LoadsInMotion out;
  options.duration = time > 0.0 ? time : any_duration;
  const Motion motion = simulate(model, start, options);
  const Trajectory& path = motion.trajectory;
  if (!motion.completed()) {
    out.why = motion.why;
    return out;
  }
  const std::size_t n = start.q.size();
  const std::size_t node = time > 0.0 ? path.nodes() - 1 : 0;
  const auto values = [&](const std::vector<double>& of) {
    const auto first = of.begin() + static_cast<std::ptrdiff_t>(node * n);
    return model.from_si({first, first + static_cast<std::ptrdiff_t>(n)});
  };
  const std::vector<double> x = values(path.q);
  const MotionModel then(at_time(model.scene(), time), model.scales(), loads_in_time(model.scene()));
  out.forces = forces_of(then, x, values(path.v), values(path.a), then.scene().drives);
  out.poses = model.poses(x);
  out.links = link_loads(then.scene(), out.poses, in_motion(then.scene(), out.forces));
  return out;
}

}  // namespace poise
