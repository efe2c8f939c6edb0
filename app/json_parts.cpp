#include "app/json_parts.hpp"

#include <cmath>

#include "app/quantity.hpp"

namespace poise::app {

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json json_number(const std::optional<double>& value) { return value ? json_number(*value) : Json(nullptr); }

Json json_scene(const Scene& scene, const std::vector<std::string>& settings) {
  return {{"file", scene.file}, {"title", scene.title}, {"source", scene.source}, {"set", settings}};
}

Json json_units(const Units& units) {
  return {{"length", unit_name(Quantity::length, units)}, {"force", unit_name(Quantity::force, units)},
          {"mass", unit_name(Quantity::mass, units)},     {"angle", unit_name(Quantity::angle, units)},
          {"moment", unit_name(Quantity::moment, units)}, {"energy", unit_name(Quantity::energy, units)}};
}

std::string json_text(const Json& document, const Scene& scene) {
  constexpr std::size_t most_bodies_read = 1000;
  const int indent = scene.bodies.size() <= most_bodies_read ? 2 : -1;
  return document.dump(indent) + "\n";
}

}  // namespace poise::app
