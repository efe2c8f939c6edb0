#include "statics/model/readings.hpp"

#include <cmath>
#include <utility>

#include "statics/bodies/body_measures.hpp"

namespace poise {

Vec2 world(const Scene& scene, const Readings& readings, PointRef point) {
  return readings.poses[point.body].world(scene.local(point));
}

Readings readings_of(const Scene& scene, std::vector<BodyPose<double>> poses) {
  Readings r;
  r.poses = std::move(poses);
  r.poses.resize(scene.bodies.size());
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const Measure travel = Measure::travel_of(static_cast<int>(j));
    r.travel.push_back(scene.joints[j].has_travel() ? value_of(scene, travel, r.poses) : 0.0);
  }
  for (const Element& element : scene.elements) {
    ElementReading reading;
    reading.value = value_of(scene, element.on, r.poses);
    reading.force = force_at_rest(element.law, reading.value).value;
    reading.slack = is_slack(element.law, reading.value);
    r.elements.push_back(reading);
  }
  for (const Stop& stop : scene.stops) r.stops.push_back(value_of(scene, stop.on, r.poses));
  return r;
}

Readings read_off(const StaticModel& model, const std::vector<double>& x) {
  return readings_of(model.scene(), model.poses(x));
}

PressedLimit pressed_limit(const Stop& stop, double value) {
  if (std::abs(value - stop.min) <= std::abs(value - stop.max)) return {"min", stop.min};
  return {"max", stop.max};
}

}  // namespace poise
