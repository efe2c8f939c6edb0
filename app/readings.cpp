#include "app/readings.hpp"

#include <cmath>

namespace poise::app {

Vec2 world(const Scene& scene, const Readings& readings, PointRef point) {
  return readings.poses[point.body].world(scene.local(point));
}

double value_of(const Scene& scene, const Readings& readings, const Measure& on) {
  double value = 0.0;
  switch (on.kind) {
    case Measure::Kind::angle:
      return readings.poses[on.body_b].angle - readings.poses[on.body_a].angle;
    case Measure::Kind::distance:
      return norm(world(scene, readings, on.b) - world(scene, readings, on.a));
    case Measure::Kind::travel:
      return readings.travel[on.joint];
    case Measure::Kind::x:
      return world(scene, readings, on.b).x;
    case Measure::Kind::y:
      return world(scene, readings, on.b).y;
    case Measure::Kind::sum:
      for (const Measure::Term& term : on.terms) value += term.factor * value_of(scene, readings, term.measure);
  }
  return value;
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
  for (const Element& element : scene.elements) {
    ElementReading reading;
    reading.value = value_of(scene, r, element.on);
    reading.force = force_at_rest(element.law, reading.value).value;
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    reading.slack = spring != nullptr && spring->slack(reading.value);
    r.elements.push_back(reading);
  }
  for (const Stop& stop : scene.stops) r.stops.push_back(value_of(scene, r, stop.on));
  return r;
}

PressedLimit pressed_limit(const Stop& stop, double value) {
  if (std::abs(value - stop.min) <= std::abs(value - stop.max)) return {"min", stop.min};
  return {"max", stop.max};
}

}  // namespace poise::app
