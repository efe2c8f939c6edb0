#include "app/shown_values.hpp"

#include <cmath>
#include <set>

namespace poise::app {

std::vector<NamedValue> angles_of(const StaticModel& model, const Readings& readings) {
  const Layout& layout = model.layout();
  std::vector<NamedValue> shown;
  for (std::size_t i = 1; i < model.scene().bodies.size(); ++i) {
    const int frame = layout.links[i].frame;
    if (frame >= 0) shown.push_back({model.scene().bodies[i].name, readings.poses[i].angle, frame < layout.kept});
  }
  return shown;
}

std::vector<NamedValue> travels_of(const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<NamedValue> shown;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    shown.push_back({scene.joints[j].name, readings.travel[j], layout.travel[j] < layout.kept});
  }
  return shown;
}

std::vector<std::size_t> free_bodies(const Layout& layout) {
  std::set<int> places;
  for (std::size_t c = 0; c < layout.coordinates.size(); ++c) {
    if (layout.coordinates[c].kind == Coordinate::Kind::length) places.insert(static_cast<int>(c));
  }
  for (const int travel : layout.travel) places.erase(travel);
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < layout.links.size(); ++i) {
    const Link& link = layout.links[i];
    if (link.parent == 0 && !link.arms.empty() && places.contains(link.arms.front().coordinate)) bodies.push_back(i);
  }
  return bodies;
}

std::vector<NamedValue> places_of(const StaticModel& model, const Readings& readings) {
  const Layout& layout = model.layout();
  std::vector<NamedValue> shown;
  for (const std::size_t i : free_bodies(layout)) {
    const Vec2 origin = readings.poses[i].origin;
    for (std::size_t k = 0; k < 2; ++k) {
      const int coordinate = layout.links[i].arms[k].coordinate;
      shown.push_back({layout.coordinates[static_cast<std::size_t>(coordinate)].name, k == 0 ? origin.x : origin.y,
                       coordinate < layout.kept});
    }
  }
  return shown;
}

double rounding_of(const ScaledModel& model, Quantity quantity) {
  constexpr double part = 1e-13;
  switch (quantity) {
    case Quantity::length:
      return part * model.scales().length;
    case Quantity::force:
      return part * model.scales().force;
    case Quantity::moment:
    case Quantity::energy:
      return part * model.scales().energy();
    default:
      return part;
  }
}

std::vector<double> in_units(const ScaledModel& model, Quantity quantity, std::vector<double> values) {
  for (double& value : values) {
    value = std::abs(value) < rounding_of(model, quantity) ? 0.0 : in_unit(value, quantity, model.scene().units);
  }
  return values;
}

}  // namespace poise::app
