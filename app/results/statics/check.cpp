#include "app/results/statics/check.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"
#include "model/parameters.hpp"

namespace poise::app {
namespace {

Line verdict(const Mobility& mobility) {
  if (!mobility.assembled) return {.text = "Cannot be assembled: " + mobility.gap + ".", .tone = Tone::bad};
  if (mobility.freedoms == 0) {
    return {.text = "All loops close; no degree of freedom that carries a load.", .tone = Tone::doubtful};
  }
  return {
      .text = fmt::format("All loops close; {}.", count(mobility.freedoms, "degree of freedom", "degrees of freedom")),
      .tone = Tone::good};
}

void add_bodies(Group& group, const Scene& scene) {
  std::vector<std::string> names, points;
  std::vector<double> masses, x, y, inertias;
  bool any_mass = false;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    names.push_back(body.name);
    std::vector<std::string> named;
    for (const NamedPoint& p : body.points) named.push_back(p.name);
    points.push_back(fmt::format("{}", fmt::join(named, ", ")));
    masses.push_back(in_unit(body.mass, Quantity::mass, scene.units));
    x.push_back(in_unit(body.center.x, Quantity::length, scene.units));
    y.push_back(in_unit(body.center.y, Quantity::length, scene.units));
    inertias.push_back(body.inertia / dimension::inertia.unit(scene.units));
    any_mass = any_mass || body.mass > 0;
  }
  Table& table = group.table("bodies", "Bodies", Rows::list);
  table.words("name", "name", std::move(names));
  const std::string length = unit_name(Quantity::length, scene.units);
  table.numbers("mass", "mass", unit_name(Quantity::mass, scene.units), std::move(masses)).shown = any_mass;
  table.numbers("center[]", "centre x", length, std::move(x)).shown = any_mass;
  table.numbers("center[]", "centre y", length, std::move(y)).shown = any_mass;
  table.numbers("inertia", "inertia", dimension::inertia.unit_name(scene.units), std::move(inertias)).shown = any_mass;
  table.words("points", "points", std::move(points));
}

void add_joints(Group& group, const Scene& scene) {
  std::vector<std::string> names, kinds, from, to;
  for (const Joint& joint : scene.joints) {
    names.push_back(joint.name);
    kinds.emplace_back(joint.traits().key);
    std::replace(kinds.back().begin(), kinds.back().end(), '_', ' ');
    from.push_back(scene.name_of(joint.a));
    to.push_back(scene.name_of(joint.b));
  }
  Table& table = group.table("joints", "Joints", Rows::list);
  table.words("name", "name", std::move(names));
  table.words("kind", "kind", std::move(kinds));
  table.words("from", "from", std::move(from));
  table.words("to", "to", std::move(to));
}

/// What a measure is taken of: "A.P to B.Q", "crank against ground".
std::string in_words(const Scene& scene, const Measure& on) {
  switch (on.kind) {
    case Measure::Kind::angle:
      return scene.bodies[on.body_b].name + " against " + scene.bodies[on.body_a].name;
    case Measure::Kind::distance:
      return scene.name_of(on.a) + " to " + scene.name_of(on.b);
    case Measure::Kind::travel:
      return "travel of " + scene.joints[on.joint].name;
    case Measure::Kind::x:
      return "x of " + scene.name_of(on.b);
    case Measure::Kind::y:
      return "y of " + scene.name_of(on.b);
    case Measure::Kind::sum:
      break;
  }
  return "a sum";
}

/// The numbers of every item of one kind: "stiffness 400 N/mm, free_length 14 mm".
std::vector<std::string> numbers_of_items(const Scene& scene, Owner owner, std::size_t items) {
  std::vector<std::string> out(items);
  for (const ParameterRow& row : parameter_table(scene)) {
    const std::optional<double> si = row.place.owner == owner ? value_at(scene, row.place) : std::nullopt;
    if (!si) continue;
    std::string& text = out[static_cast<std::size_t>(row.place.item)];
    const std::string_view key = row.path.parts[2].empty() ? row.path.parts[3] : row.path.parts[2];
    text += fmt::format("{}{}{}{} {}", text.empty() ? "" : ", ", key, key.empty() ? "" : " ",
                        significant(*si / row.dimension.unit(scene.units), force_digits),
                        row.dimension.unit_name(scene.units));
  }
  return out;
}

void add_elements(Group& group, const Scene& scene) {
  std::vector<std::string> names, kinds, measures;
  for (const Element& element : scene.elements) {
    names.push_back(element.name);
    kinds.push_back(element.table);
    std::replace(kinds.back().begin(), kinds.back().end(), '_', ' ');
    measures.push_back(in_words(scene, element.on));
  }
  Table& table = group.table("elements", "Springs, dampers and other force elements", Rows::list);
  table.words("name", "name", std::move(names));
  table.words("kind", "kind", std::move(kinds));
  table.words("on", "on", std::move(measures));
  table.words("numbers", "numbers", numbers_of_items(scene, Owner::element, scene.elements.size()));
}

void add_loads(Group& group, const Scene& scene) {
  std::vector<std::string> names, at, values;
  for (const Force& force : scene.forces) {
    const auto part = [&](double si) { return significant(in_unit(si, Quantity::force, scene.units), force_digits); };
    names.push_back(force.name);
    at.push_back(scene.name_of(force.at));
    values.push_back(fmt::format("[{}, {}] {}{}", part(force.vector.x), part(force.vector.y), scene.units.force_name,
                                 force.follows < 0 ? "" : ", follows " + scene.bodies[force.follows].name));
  }
  const std::vector<std::string> torques = numbers_of_items(scene, Owner::torque, scene.torques.size());
  for (std::size_t i = 0; i < scene.torques.size(); ++i) {
    names.push_back(scene.torques[i].name);
    at.push_back(scene.bodies[scene.torques[i].body].name);
    values.push_back(torques[i]);
  }
  Table& table = group.table("loads", "Loads", Rows::list);
  table.words("name", "name", std::move(names));
  table.words("on", "on", std::move(at));
  table.words("value", "value", std::move(values));
}

void add_stops_and_drives(Group& group, const Scene& scene) {
  std::vector<std::string> names, measures, ranges;
  for (const Stop& stop : scene.stops) {
    const Quantity quantity = quantity_of(stop.on);
    const auto limit = [&](double si) {
      return std::isfinite(si) ? significant(in_unit(si, quantity, scene.units), force_digits) : std::string("any");
    };
    names.push_back(stop.name);
    measures.push_back(in_words(scene, stop.on));
    ranges.push_back(fmt::format("{} to {} {}", limit(stop.min), limit(stop.max), unit_name(quantity, scene.units)));
  }
  Table& stops = group.table("stops", "Stops", Rows::list);
  stops.words("name", "name", std::move(names));
  stops.words("on", "on", std::move(measures));
  stops.words("range", "range", std::move(ranges));
  std::vector<std::string> driven, drives;
  for (const Drive& drive : scene.drives) {
    driven.push_back(drive.name);
    drives.push_back(in_words(scene, drive.on));
  }
  Table& table = group.table("drives", "Drives", Rows::list);
  table.words("name", "name", std::move(driven));
  table.words("on", "on", std::move(drives));
  table.words("numbers", "numbers", numbers_of_items(scene, Owner::drive, scene.drives.size()));
}

}  // namespace

Result check_result(const StaticModel& model, const Mobility& mobility, const std::vector<std::string>& settings) {
  const Scene& scene = model.scene();
  Result out = scene_result(scene, settings);
  out.verdict = verdict(mobility);
  Group& content = out.content;
  content.data("assembled", mobility.assembled);
  content.data("gap", mobility.gap);
  for (const auto& [key, number] :
       {std::pair{"moving_bodies", mobility.bodies}, std::pair{"moving_joints", mobility.joints},
        std::pair{"coordinates", mobility.coordinates}, std::pair{"closure_equations", mobility.closures},
        std::pair{"rank", mobility.rank}, std::pair{"degrees_of_freedom", mobility.freedoms},
        std::pair{"gruebler", mobility.gruebler}}) {
    content.data(key, number);
  }
  content.fact("mechanism", count(mobility.bodies, "moving body", "moving bodies") + ", " +
                                count(mobility.joints, "joint", "joints"));
  content.fact("model", fmt::format("{}, {} of rank {}", count(mobility.coordinates, "coordinate", "coordinates"),
                                    count(mobility.closures, "closure equation", "closure equations"), mobility.rank));
  content.fact("mobility",
               fmt::format("{}; counting bodies and joints (Gruebler) gives {}",
                           mobility.freedoms > 0 ? count(mobility.freedoms, "degree of freedom", "degrees of freedom")
                                                 : "no degree of freedom that carries a load",
                           mobility.gruebler),
               mobility.freedoms > 0 ? Tone::plain : Tone::doubtful);
  content.fact("constraints",
               mobility.redundant.empty() ? "no constraint repeats or contradicts another"
               : mobility.assembled       ? "some constraints are redundant"
                                          : "some constraints are redundant or conflict",
               mobility.redundant.empty() ? Tone::plain : Tone::doubtful);
  const std::string acceleration = dimension::acceleration.unit_name(scene.units);
  content.data("gravity", std::vector<double>{in_unit(scene.gravity.x, Quantity::length, scene.units),
                                              in_unit(scene.gravity.y, Quantity::length, scene.units)});
  content.fact("gravity", norm(scene.gravity) == 0.0
                              ? "none"
                              : fmt::format("[{}, {}] {}, {} m/s²",
                                            significant(in_unit(scene.gravity.x, Quantity::length, scene.units), 6),
                                            significant(in_unit(scene.gravity.y, Quantity::length, scene.units), 6),
                                            acceleration, significant(norm(scene.gravity), 4)));
  content.list("redundant_joints", mobility.assembled ? "Redundant joints" : "Redundant or conflicting joints",
               mobility.redundant);
  add_bodies(content, scene);
  add_joints(content, scene);
  add_elements(content, scene);
  add_loads(content, scene);
  add_stops_and_drives(content, scene);
  content.list("kept", "Coordinates of the static model, and why", mobility.kept);
  content.list("dropped", "Left out of statics", mobility.dropped);
  return out;
}

}  // namespace poise::app
