#include "app/experiment_units.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>

namespace poise::app {
namespace {

/// Unit of a load: a force, or a torque.
Quantity quantity_of_load(const Unknown& unknown, const Scene& scene) {
  const std::string_view name = std::string_view(unknown.path).substr(std::string_view("load.").size());
  const bool torque =
      std::any_of(scene.torques.begin(), scene.torques.end(), [&](const auto& t) { return t.name == name; });
  return torque ? Quantity::moment : Quantity::force;
}

}  // namespace

std::string unit_name(const Unknown& unknown, const Scene& scene) {
  const Units& u = scene.units;
  const std::string_view path = unknown.path;
  std::string moment = unit_name(Quantity::moment, u);
  const bool turning = path.starts_with("torsion_");
  if (path.starts_with("load.")) return unit_name(quantity_of_load(unknown, scene), u);
  if (path.ends_with(".mass")) return u.mass_name;
  if (path.ends_with(".inertia")) return fmt::format("{} {}²", u.mass_name, u.length_name);
  if (path.ends_with(".stiffness")) {
    return turning ? fmt::format("{}/{}", moment, u.angle_name) : fmt::format("{}/{}", u.force_name, u.length_name);
  }
  if (path.ends_with(".coefficient")) {
    return turning ? fmt::format("{} s/{}", moment, u.angle_name) : fmt::format("{} s/{}", u.force_name, u.length_name);
  }
  if (path.ends_with(".torque")) return moment;
  return turning ? u.angle_name : u.length_name;  // free angle; free length, centre
}

Quantity quantity_of(const Sensor& sensor) {
  switch (sensor.kind) {
    case Sensor::Kind::angle:
      return Quantity::angle;
    case Sensor::Kind::spring_force:
      return Quantity::force;
    case Sensor::Kind::travel:
    case Sensor::Kind::distance:
    case Sensor::Kind::x:
    case Sensor::Kind::y:
      break;
  }
  return Quantity::length;
}

std::string unit_name(const Sensor& sensor, const Units& units) {
  return unit_name(quantity_of(sensor), units) + (sensor.rate ? "/s" : "");
}

double in_unit(double si, const Sensor& sensor, const Units& units) { return in_unit(si, quantity_of(sensor), units); }

std::vector<Quantity> nuisance_quantities(const RunModel& run) {
  std::vector<Quantity> out;
  if (run.rest_is_unknown()) out.push_back(run.run().rest->body >= 0 ? Quantity::angle : Quantity::length);
  if (!run.start_is_unknown()) return out;
  const Layout layout = lay_out(run.scene(), Purpose::dynamics);
  for (int rates = 0; rates < 2; ++rates) {
    for (const int i : run.independent()) {
      const bool angle = layout.coordinates[static_cast<std::size_t>(i)].kind == Coordinate::Kind::angle;
      out.push_back(angle ? Quantity::angle : Quantity::length);
    }
  }
  return out;
}

}  // namespace poise::app
