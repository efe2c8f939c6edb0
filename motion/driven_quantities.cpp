#include "motion/driven_quantities.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "model/parameters.hpp"
#include "statics/model/scaling.hpp"

namespace poise {
namespace {

/// The size of a scene is that of its largest body: scales need no more.
double size_of_bodies(const Scene& scene) {
  double largest = 0.0;
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& point : body.points) largest = std::max(largest, norm(point.at));
  }
  return largest > 0.0 ? largest : 1.0;
}

/// Bodies where they are, with drives that hold their measures and the stops `active`.
RestingPlace place_of(Scene scene, const std::vector<Drive>& drives, const std::vector<BodyMotion>& bodies,
                      std::vector<int> active) {
  RestingPlace out;
  out.scales = choose_scales(scene, size_of_bodies(scene));
  out.driven = static_cast<int>(scene.stops.size());
  for (const Drive& drive : drives) {
    active.push_back(static_cast<int>(scene.stops.size()));
    Stop& motor = scene.stops.emplace_back();
    motor.name = drive.name;
    motor.on = drive.on;
    motor.min = motor.max = 0.0;
  }
  if (drives.empty()) out.driven = -1;
  out.active = std::move(active);
  const Vec2 anchor = bodies.front().pose.origin;
  const double length = out.scales.length;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const BodyPose<double>& pose = bodies[i].pose;
    const Vec2 at = (1.0 / length) * (pose.origin - anchor);
    out.poses.insert(out.poses.end(), {at.x, at.y, pose.angle});
  }
  out.scene = scaled(scene, out.scales);
  return out;
}

}  // namespace

std::vector<QuantityValue> driven_quantities(const Scene& scene, const std::vector<Drive>& drives,
                                             const std::vector<BodyMotion>& bodies,
                                             const std::vector<SoughtQuantity>& of) {
  return quantity_values(place_of(scene, drives, bodies, {}), of);
}

std::vector<QuantityValue> driven_quantities(const Scene& scene, const Forces& forces,
                                             const std::vector<SoughtQuantity>& of) {
  std::vector<int> active;
  for (const Reaction& reaction : forces.reactions) {
    if (reaction.of_stop()) active.push_back(reaction.stop);
  }
  RestingPlace place = place_of(scene, scene.drives, forces.motions, std::move(active));
  std::vector<SourcedForce> beside;
  for (SourcedForce& one : forces_on_bodies(scene, forces)) {
    const bool resists = std::any_of(scene.elements.begin(), scene.elements.end(), [&](const Element& element) {
      return element.table == one.kind && element.name == one.name && !stores_energy(element.law);
    });
    if (one.kind == "inertia" || one.kind == "friction" || resists) beside.push_back(std::move(one));
  }
  const double length = place.scales.length, force = place.scales.force;
  for (const SourcedForce& one : beside) {
    place.beside.push_back(
        {one.on.body, (1.0 / length) * one.on.at, (1.0 / force) * one.on.force, one.on.moment / (force * length)});
  }
  return quantity_values(place, of);
}

}  // namespace poise
