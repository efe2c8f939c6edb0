#include "app/experiment_units.hpp"

#include <cstdlib>

#include "model/parameters.hpp"

namespace poise::app {
namespace {

/// "N m s/rad"; `seconds` is the exponent of time.
std::string unit_name(const Dimension& dimension, int seconds, const Units& units) {
  std::string above, below;
  const auto add = [&](const std::string& name, int power) {
    if (power == 0) return;
    const std::string factor = name + (std::abs(power) == 2 ? "²" : std::abs(power) == 3 ? "³" : "");
    if (power > 0)
      above += (above.empty() ? "" : " ") + factor;
    else
      below += "/" + factor;
  };
  add(units.mass_name, dimension.mass);
  add(units.force_name, dimension.force);
  add(units.length_name, dimension.length);
  add(units.angle_name, dimension.angle);
  add("s", seconds);
  return above + below;
}

}  // namespace

std::string unit_name(const Unknown& unknown, const Scene& scene) {
  const int seconds = unknown.path.ends_with(".coefficient") ? 1 : unknown.path.ends_with(".width") ? -1 : 0;
  return unit_name(parameter(scene, unknown.path).dimension, seconds, scene.units);
}

Quantity quantity_of(const Sensor& sensor) {
  return sensor.reads_force() ? effort_of(sensor.on) : quantity_of(sensor.on);
}

std::string unit_name(const Sensor& sensor, const Units& units) {
  return unit_name(quantity_of(sensor), units) + (sensor.rate ? "/s" : "");
}

double in_unit(double si, const Sensor& sensor, const Units& units) { return in_unit(si, quantity_of(sensor), units); }

std::vector<Quantity> nuisance_quantities(const RunModel& run) {
  std::vector<Quantity> out;
  if (run.equilibrium_is_unknown())
    out.push_back(run.run().equilibrium->body >= 0 ? Quantity::angle : Quantity::length);
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
