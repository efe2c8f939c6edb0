#include "app/shown_values.hpp"

#include <cmath>

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

std::vector<NamedValue> lengths_of(const StaticModel& model, const Readings& readings, const std::vector<double>& x) {
  const Scene& scene = model.scene();
  const Layout& layout = model.layout();
  std::vector<bool> is_travel(layout.coordinates.size(), false);
  std::vector<NamedValue> shown;
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    is_travel[layout.travel[j]] = true;
    shown.push_back({scene.joints[j].name, readings.travel[j], layout.travel[j] < layout.kept});
  }
  const std::vector<double> q = model.to_si(x);
  for (std::size_t t = 0; t < layout.coordinates.size(); ++t) {
    const Coordinate& c = layout.coordinates[t];
    if (c.kind != Coordinate::Kind::length || is_travel[t]) continue;
    const bool kept = t < q.size();
    shown.push_back({c.name, kept ? q[t] : c.start * model.scales().length, kept});
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
