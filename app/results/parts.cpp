#include "app/results/parts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "app/present/cells.hpp"
#include "app/present/numbers.hpp"

namespace poise::app {
namespace {

/// Name of the body on which a measure's force acts, the opposite acting on the first; a sum has several.
std::string second_body(const Scene& scene, const Measure& on) {
  switch (on.kind) {
    case Measure::Kind::angle:
      return scene.bodies[on.body_b].name;
    case Measure::Kind::travel:
      return scene.bodies[scene.joints[on.joint].b.body].name;
    case Measure::Kind::distance:
    case Measure::Kind::x:
    case Measure::Kind::y:
      return scene.bodies[on.b.body].name;
    case Measure::Kind::sum:
      break;
  }
  return "(sum)";
}

/// The body that a reaction acts on, by the name of its joint or stop.
class ReactionBodies {
 public:
  explicit ReactionBodies(const Scene& scene) {
    for (const Joint& joint : scene.joints) joints_.emplace(joint.name, scene.bodies[joint.b.body].name);
    for (const Stop& stop : scene.stops) stops_.emplace(stop.name, second_body(scene, stop.on));
  }
  const std::string& of(const Reaction& reaction) const {
    return (reaction.kind == "stop" ? stops_ : joints_).at(reaction.name);
  }

 private:
  std::unordered_map<std::string, std::string> joints_, stops_;
};

/// The rows of a table of coordinates: which of the values are shown, under which name.
struct CoordinateRows {
  std::vector<std::size_t> places;
  std::vector<std::string> names;
};

CoordinateRows all_rows(const std::vector<NamedValue>& values) {
  CoordinateRows rows;
  for (std::size_t i = 0; i < values.size(); ++i) {
    rows.places.push_back(i);
    rows.names.push_back(values[i].name);
  }
  return rows;
}

/// Bodies that welds join in one row.
CoordinateRows rigid_rows(const Scene& scene, const std::vector<NamedValue>& angles) {
  const std::vector<int> groups = rigid_groups(scene);
  std::unordered_map<std::string, int> group_of;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) group_of.emplace(scene.bodies[i].name, groups[i]);
  std::unordered_map<int, std::size_t> row_of;
  CoordinateRows rows;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    const auto [row, is_new] = row_of.emplace(group_of.at(angles[i].name), rows.places.size());
    if (is_new) {
      rows.places.push_back(i);
      rows.names.push_back(angles[i].name);
    } else {
      rows.names[row->second] += ", " + angles[i].name;
    }
  }
  return rows;
}

void add_values(Group& group, const StaticModel& model, const std::string& title, const std::string& noun,
                Quantity quantity, const CoordinateRows& rows, const std::vector<std::vector<NamedValue>>& poses,
                const std::vector<std::string>& titles) {
  if (rows.places.empty()) return;
  const Units& units = model.scene().units;
  // The same decimals for all columns, and for angles that have made many turns.
  const double scale = in_unit(quantity == Quantity::angle ? M_PI : model.scales().length, quantity, units);
  Table& table = group.table("", fmt::format("{} ({})", title, unit_name(quantity, units)), Rows::list);
  table.words("", noun, rows.names);
  std::vector<std::string> notes;
  for (const std::size_t i : rows.places) {
    notes.emplace_back(poses.front()[i].determined ? "" : "free: carries no load, left at its start");
  }
  for (std::size_t c = 0; c < poses.size(); ++c) {
    std::vector<double> values;
    for (const std::size_t i : rows.places) values.push_back(in_unit(poses[c][i].value, quantity, units));
    Format format = format_of(model, quantity, coordinate_digits);
    format.scale = scale;
    table.numbers("", titles[c], "", std::move(values), format);
  }
  table.remarks(std::move(notes), Tone::faint);
}

}  // namespace

Result scene_result(const Scene& scene, const std::vector<std::string>& settings) {
  constexpr std::size_t most_bodies_read = 1000;
  Result out{.title = scene.title.empty() ? scene.file : scene.title, .source = scene.source};
  out.compact = scene.bodies.size() > most_bodies_read;
  Group& of_scene = out.content.group("scene", "", Verbosity::data);
  of_scene.data("file", scene.file);
  of_scene.data("title", scene.title);
  of_scene.data("source", scene.source);
  of_scene.data("set", settings);
  add_units(out.content, scene.units);
  return out;
}

void add_units(Group& group, const Units& units) {
  Group& names = group.group("units", "", Verbosity::data);
  for (const auto& [name, quantity] : {std::pair{"length", Quantity::length}, std::pair{"force", Quantity::force},
                                       std::pair{"mass", Quantity::mass}, std::pair{"angle", Quantity::angle},
                                       std::pair{"moment", Quantity::moment}, std::pair{"energy", Quantity::energy}}) {
    names.data(name, unit_name(quantity, units));
  }
}

Format format_of(const ScaledModel& model, Quantity quantity, int digits, Format::Style style) {
  constexpr double part = 1e-13;
  double scale = 1.0;
  if (quantity == Quantity::length) scale = model.scales().length;
  if (quantity == Quantity::force) scale = model.scales().force;
  if (quantity == Quantity::moment || quantity == Quantity::energy) scale = model.scales().energy();
  return {.style = style, .digits = digits, .zero_below = in_unit(part * scale, quantity, model.scene().units)};
}

Column& add_column(Table& table, const ScaledModel& model, const std::string& key, const std::string& title,
                   Quantity quantity, const std::vector<double>& si, int digits) {
  const Units& units = model.scene().units;
  return table.numbers(key, title, unit_name(quantity, units), in_unit(si, quantity, units),
                       format_of(model, quantity, digits));
}

std::string with_unit(const ScaledModel& model, double si, Quantity quantity, int digits) {
  const Units& units = model.scene().units;
  return text_of(Entry{.value = in_unit(si, quantity, units),
                       .unit = unit_name(quantity, units),
                       .format = format_of(model, quantity, digits, Format::Style::significant)});
}

std::string in_words(const Check& check) {
  std::string text = to_string(check.stability);
  const auto add = [&](int number, const std::string& what) {
    if (number > 0) text += ", " + count(number, what + " direction", what + " directions");
  };
  add(check.unstable_directions, "unstable");
  add(check.neutral_directions, "neutral");
  return text;
}

Tone tone_of(Stability stability) {
  switch (stability) {
    case Stability::stable:
      return Tone::good;
    case Stability::unstable:
      return Tone::bad;
    case Stability::neutral:
    case Stability::unknown:
      return Tone::doubtful;
  }
  return Tone::plain;
}

void add_coordinates(Group& group, const StaticModel& model, const std::vector<const Readings*>& poses,
                     const std::vector<std::string>& titles) {
  if (poses.empty()) return;
  std::vector<std::vector<NamedValue>> angles, travels, places;
  for (const Readings* pose : poses) {
    angles.push_back(angles_of(model, *pose));
    travels.push_back(travels_of(model, *pose));
    places.push_back(places_of(model, *pose));
  }
  add_values(group, model, "Angles", "body", Quantity::angle, rigid_rows(model.scene(), angles.front()), angles,
             titles);
  add_values(group, model, "Slides", "joint", Quantity::length, all_rows(travels.front()), travels, titles);
  add_values(group, model, "Positions of free bodies", "body", Quantity::length, all_rows(places.front()), places,
             titles);
}

void add_reactions(Group& group, const ScaledModel& model, const std::vector<Reaction>& reactions, int redundancy,
                   Verbosity level) {
  const Units& units = model.scene().units;
  const ReactionBodies bodies(model.scene());
  std::vector<std::string> names, kinds, on, notes;
  std::vector<double> at_x, at_y, x, y, size, moments, axials, shown_axials, determined;
  double largest = 0.0;
  bool any_moment = false, any_axial = false;
  for (const Reaction& r : reactions) {
    names.push_back(r.name);
    kinds.push_back(r.kind);
    on.push_back(bodies.of(r));
    at_x.push_back(r.at.x);
    at_y.push_back(r.at.y);
    x.push_back(r.force.x);
    y.push_back(r.force.y);
    size.push_back(norm(r.force));
    largest = std::max(largest, size.back());
    moments.push_back(r.moment);
    any_moment = any_moment || std::abs(in_unit(r.moment, Quantity::moment, units)) >
                                   format_of(model, Quantity::moment, force_digits).zero_below;
    const bool is_axial = r.kind == "bar" || r.axial != 0.0;
    axials.push_back(r.axial);
    shown_axials.push_back(is_axial ? r.axial : std::numeric_limits<double>::quiet_NaN());
    any_axial = any_axial || is_axial;
    determined.push_back(r.determined ? 1.0 : 0.0);
    notes.emplace_back(r.determined ? "" : "undetermined");
  }
  const bool any_stop = std::find(kinds.begin(), kinds.end(), "stop") != kinds.end();
  const std::string heading = any_stop ? "Forces of joints and active stops" : "Joint forces";
  Table& table = group.table("reactions", heading + " on the named body, along world axes", Rows::list, level);
  table.words("name", "joint", std::move(names));
  table.words("kind", "kind", std::move(kinds));
  table.words("on", "on", std::move(on));
  table.data("at[]", in_unit(at_x, Quantity::length, units));
  table.data("at[]", in_unit(at_y, Quantity::length, units));
  const auto add_force = [&](const std::string& key, const std::string& title, const std::vector<double>& values) {
    add_column(table, model, key, title, Quantity::force, values, force_digits).format.scale =
        in_unit(largest, Quantity::force, units);
  };
  add_force("force[]", "Fx", x);
  add_force("force[]", "Fy", y);
  add_force("", "|F|", size);
  add_column(table, model, "moment", "moment", Quantity::moment, moments, force_digits).shown = any_moment;
  table.data("axial", in_unit(axials, Quantity::force, units));
  add_column(table, model, "", "tension", Quantity::force, shown_axials, force_digits).shown = any_axial;
  table.flags("determined", std::move(determined));
  table.remarks(std::move(notes), Tone::doubtful);
  if (redundancy > 0) {
    table.footnotes.push_back(count(redundancy, "state of self-stress", "states of self-stress") +
                              ": statics does not determine the marked forces; shown are those of minimum norm");
  }
}

void warn_of_friction(Result& result, const Scene& scene) {
  std::vector<std::string> names;
  for (const Element& element : scene.elements) {
    const auto* friction = std::get_if<DryFriction>(&element.law);
    if (friction != nullptr && friction->force != 0.0) names.push_back("\"" + element.name + "\"");
  }
  if (names.empty()) return;
  result.warnings.push_back(
      {.text = fmt::format("Dry friction is left out: {} may hold the mechanism elsewhere too.", listed(names)),
       .tone = Tone::doubtful});
}

}  // namespace poise::app
