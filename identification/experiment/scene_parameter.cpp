#include "identification/experiment/scene_parameter.hpp"

#include <algorithm>
#include <cmath>

#include "model/dependent_number.hpp"
#include "model/joint_friction.hpp"

namespace poise {

std::optional<SceneParameter> SceneParameter::find(const Scene& scene, std::string_view path) {
  const std::optional<ParameterRow> row = find_parameter(scene, path);
  if (!row) return std::nullopt;
  // Motion depends on none of these.
  if (row->place.owner == Owner::start || row->place.owner == Owner::section) return std::nullopt;
  const std::optional<double> value = value_at(scene, row->place);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  // A stop that holds its measure is a part of the mechanism.
  if (row->place.owner == Owner::stop && scene.stops[static_cast<std::size_t>(row->place.item)].holds()) {
    return std::nullopt;
  }
  return SceneParameter(*row);
}

void SceneParameter::set(Scene& scene, double si) const {
  if (place_.owner == Owner::force && scene.forces[static_cast<std::size_t>(place_.item)].line_of_action() == Vec2{}) {
    return;
  }
  set_value_at(scene, place_, si);
  let_friction_follow(scene);
}

bool SceneParameter::allows(const Scene& scene, double si) const {
  // Without a length a slide has no carriage: another mechanism.
  if (is_friction_ && path_.ends_with(".friction.length")) return si > 0;
  // An exponent, or the ratio of a gas strut, may have to be more than 1.
  const bool has_law = place_.owner == Owner::element && range_ == Range::positive;
  if (!is_named() && !is_of_stop() && place_.owner != Owner::time && place_.owner != Owner::coupling && !has_law) {
    return range_ != Range::positive || si > 0;
  }
  if (range_ == Range::positive && si <= 0) return false;
  try {
    Scene changed = scene;
    set_value_at(changed, place_, si);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

double SceneParameter::reach(const Scene& scene, double length) const {
  const std::vector<double> slopes = dependents_by(scene, place_.item, named_values(scene));
  double least = INFINITY;
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const DependentNumber& one = (*scene.dependents)[k];
    const bool is_row = one.at.of == DependentPlace::Of::row;
    const Owner owner = one.at.place.owner;
    const bool is_geometric = is_dimension(owner) || owner == Owner::scene;
    double size = is_row ? std::abs(value_at(scene, one.at.place).value_or(0.0)) : 1.0;
    if (is_row && is_geometric)
      size = std::max(size, one.dimension.length == 1 && one.dimension.time == 0 ? length : 1.0);
    if (one.at.of == DependentPlace::Of::force) size = value_at(scene, one.at.place).value_or(0.0);
    const double change = size / std::abs(slopes[k]);
    if (change > 0 && std::isfinite(change)) least = std::min(least, change);
  }
  return std::isfinite(least) ? least : std::max(1.0, std::abs(get(scene)));
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
  if (place_.owner == Owner::time) {  // in SI, whatever the scene's units
    const TimeFunction& function = scene.time_functions[static_cast<std::size_t>(place_.item)];
    if (function.of == TimeFunction::Of::drive) {
      out.drive = function.item;
      out.drive_number = place_.number;
      return out;
    }
    out.force = force_number(function.of, function.item, function.part, place_.number);
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

std::vector<Influence::InTime> SceneParameter::in_time(const Scene& scene, const Scales& scales) const {
  std::vector<Influence::InTime> out;
  if (!is_named()) return out;
  const std::vector<double> slopes = dependents_by(scene, place_.item, named_values(scene));
  for (std::size_t k = 0; k < slopes.size(); ++k) {
    const DependentNumber& one = (*scene.dependents)[k];
    const ParameterPlace& place = one.at.place;
    const bool drives = place.owner == Owner::drive && one.at.of == DependentPlace::Of::row;
    if ((place.owner != Owner::time && !drives) || slopes[k] == 0.0) continue;
    if (!std::isfinite(slopes[k])) {
      throw InputError(one.item + " = \"" + one.text() + "\" has no derivative by " + path_);
    }
    if (drives) {
      const double unit = one.dimension.per_scale(scales);
      out.push_back({TimeFunction::Of::drive, place.item, place.number, unit * slopes[k]});
      continue;
    }
    const TimeFunction& function = scene.time_functions[static_cast<std::size_t>(place.item)];
    out.push_back({function.of, function.item, place.number, slopes[k], function.part});
  }
  return out;
}

double SceneParameter::force_by(const Scene& scene, int element, double g, double w) const {
  if (place_.owner != Owner::element || place_.item != element) return 0.0;
  return force_by_number(scene.elements[static_cast<std::size_t>(element)].law, place_.number, g, w);
}

}  // namespace poise
