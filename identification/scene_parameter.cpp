#include "identification/scene_parameter.hpp"

namespace poise {

std::optional<SceneParameter> SceneParameter::find(const Scene& scene, std::string_view path) {
  const std::optional<ParameterRow> row = find_parameter(scene, path);
  if (!row) return std::nullopt;
  if (row->place.owner == Owner::start || row->place.owner == Owner::stop) return std::nullopt;
  if (!value_at(scene, row->place)) return std::nullopt;
  return SceneParameter(*row);
}

void SceneParameter::set(Scene& scene, double si) const {
  if (place_.owner == Owner::force && get(scene) == 0.0) return;
  set_value_at(scene, place_, si);
}

Influence SceneParameter::influence(const Scene& scene, const Scales& scales) const {
  Influence out;
  if (is_inertial()) {
    const BodyInertia<double> by = inertia_by(scene.bodies[static_cast<std::size_t>(place_.item)], place_.number);
    out.body = place_.item;
    out.mass = dimension::mass.per_scale(scales) * by.mass;
    out.first = (dimension::mass * dimension::length).per_scale(scales) * by.first;
    out.moment = dimension::inertia.per_scale(scales) * by.moment;
    return out;
  }
  out.by = dimension_.per_scale(scales);
  if (place_.owner == Owner::drive) {
    out.drive = place_.item;
    out.drive_number = place_.number;
    return out;
  }
  out.force.of = place_.owner == Owner::element ? ForceNumber::Of::element
                 : place_.owner == Owner::force ? ForceNumber::Of::force
                                                : ForceNumber::Of::torque;
  out.force.item = place_.item;
  out.force.number = place_.number;
  return out;
}

double SceneParameter::force_by(const Scene& scene, int element, double g, double w) const {
  if (place_.owner != Owner::element || place_.item != element) return 0.0;
  return force_by_number(scene.elements[static_cast<std::size_t>(element)].law, place_.number, g, w);
}

}  // namespace poise
