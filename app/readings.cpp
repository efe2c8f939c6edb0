#include "app/readings.hpp"

#include <cmath>

namespace poise::app {

Vec2 world(const Scene& scene, const Readings& readings, PointRef point) {
  return readings.poses[point.body].world(scene.local(point));
}

Readings read_off(const StaticModel& model, const std::vector<double>& x) {
  const Scene& scene = model.scene();
  Readings r;
  r.poses = model.poses(x);
  r.poses.resize(scene.bodies.size());
  for (const Joint& joint : scene.joints) {
    const Vec2 along = joint.axis * unit(r.poses[joint.a.body].angle);
    r.travel.push_back(joint.has_travel() ? dot(along, world(scene, r, joint.b) - world(scene, r, joint.a)) : 0.0);
  }
  for (const Spring& spring : scene.springs) {
    SpringReading reading;
    reading.length = norm(world(scene, r, spring.b) - world(scene, r, spring.a));
    const double stretch = reading.length - spring.free_length;
    reading.slack = (spring.acts == Spring::Acts::tension && stretch <= 0) ||
                    (spring.acts == Spring::Acts::compression && stretch >= 0);
    reading.force = reading.slack ? 0.0 : spring.stiffness * stretch;
    r.springs.push_back(reading);
  }
  for (const TorsionSpring& spring : scene.torsion_springs) {
    r.torsion_moments.push_back(-spring.stiffness *
                                (r.poses[spring.b].angle - r.poses[spring.a].angle - spring.free_angle));
  }
  for (const Stop& stop : scene.stops) {
    switch (stop.kind) {
      case Stop::Kind::angle:
        r.stops.push_back(r.poses[stop.body_b].angle - r.poses[stop.body_a].angle);
        break;
      case Stop::Kind::distance:
        r.stops.push_back(norm(world(scene, r, stop.b) - world(scene, r, stop.a)));
        break;
      case Stop::Kind::travel:
        r.stops.push_back(r.travel[stop.joint]);
        break;
    }
  }
  return r;
}

PressedLimit pressed_limit(const Stop& stop, double value) {
  if (std::abs(value - stop.min) <= std::abs(value - stop.max)) return {"min", stop.min};
  return {"max", stop.max};
}

Quantity quantity_of(const Stop& stop) { return stop.kind == Stop::Kind::angle ? Quantity::angle : Quantity::length; }

}  // namespace poise::app
