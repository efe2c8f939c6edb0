#include "app/results/parts.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "app/result/cells.hpp"
#include "app/result/numbers.hpp"
#include "model/couplings.hpp"
#include "model/joint_friction.hpp"
#include "model/meshing.hpp"
#include "statics/model/pose_values.hpp"
#include "statics/model/readings.hpp"

namespace poise::app {
namespace {

NamedRows all_rows(const std::vector<NamedValue>& values) {
  return {places(values.size()), each(values, &NamedValue::name)};
}

void add_values(Group& group, const StaticModel& model, const std::string& title, const std::string& noun,
                Quantity quantity, const NamedRows& rows, const std::vector<std::vector<NamedValue>>& poses,
                const std::vector<std::string>& titles, double radius) {
  if (rows.places.empty()) return;
  const Units& units = model.scene().units;
  // The same decimals for all columns, and for angles that have made many turns.
  const double whole = quantity == Quantity::angle ? M_PI : model.scales().length;
  const double scale = in_unit(whole, quantity, units);
  const double doubt = quantity == Quantity::angle ? radius : radius * model.scales().length;
  Table& table = group.table("", fmt::format("{} ({})", title, unit_name(quantity, units)), Rows::list);
  table.words("", noun, rows.names);
  for (std::size_t c = 0; c < poses.size(); ++c) {
    const auto value = [&](std::size_t i) { return in_unit(poses[c][i].value, quantity, units); };
    Format format = format_of(model, quantity, coordinate_digits, Format::Style::aligned, doubt);
    format.scale = scale;
    table.numbers("", titles[c], "", each(rows.places, value), format);
  }
  const auto remark = [&](std::size_t i) {
    return poses.front()[i].determined ? "" : "free: carries no load, left at its start";
  };
  table.remarks(each(rows.places, remark), Tone::faint);
}

void add_held_loads(Group& content, const Scene& scene) {
  content.list("held_loads", "Loads and springs that follow functions of time, held at one time",
               each(scene.held_loads, [](const HeldLoad& held) {
                 return fmt::format("{}: a {}, at t = {} s {:.6g} times what the scene gives", held.name, held.kind,
                                    held.time, held.factor);
               }));
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
  add_held_loads(out.content, scene);
  return out;
}

void add_named(Group& group, const std::string& key, const std::vector<NamedValue>& values, Quantity quantity,
               const Units& units) {
  Table& table = group.table(key, "", Rows::values, Verbosity::data);
  table.words("name", "", each(values, &NamedValue::name));
  table.data("value", in_unit(each(values, &NamedValue::value), quantity, units));
}

void add_units(Group& group, const Units& units) {
  Group& names = group.group("units", "", Verbosity::data);
  for (const auto& [name, quantity] : {std::pair{"length", Quantity::length}, std::pair{"force", Quantity::force},
                                       std::pair{"mass", Quantity::mass}, std::pair{"angle", Quantity::angle},
                                       std::pair{"moment", Quantity::moment}, std::pair{"energy", Quantity::energy}}) {
    names.data(name, unit_name(quantity, units));
  }
}

Format format_of(const ScaledModel& model, Quantity quantity, int digits, Format::Style style, double radius) {
  constexpr double part = 1e-13;
  double scale = 1.0;
  if (quantity == Quantity::length) scale = model.scales().length;
  if (quantity == Quantity::force) scale = model.scales().force;
  if (quantity == Quantity::moment || quantity == Quantity::energy) scale = model.scales().energy();
  const Units& units = model.scene().units;
  return {.style = style,
          .digits = digits,
          .zero_below = in_unit(part * scale, quantity, units),
          .radius = in_unit(radius, quantity, units)};
}

Column& add_column(Table& table, const ScaledModel& model, const std::string& key, const std::string& title,
                   Quantity quantity, const std::vector<double>& si, int digits, double radius) {
  const Units& units = model.scene().units;
  return table.numbers(key, title, unit_name(quantity, units), in_unit(si, quantity, units),
                       format_of(model, quantity, digits, Format::Style::aligned, radius));
}

std::string with_unit(const ScaledModel& model, double si, Quantity quantity, int digits, double radius) {
  const Units& units = model.scene().units;
  return text_of(Entry{.value = in_unit(si, quantity, units),
                       .unit = unit_name(quantity, units),
                       .format = format_of(model, quantity, digits, Format::Style::significant, radius)});
}

std::string amount(double si, Quantity quantity, const Units& units, int digits, std::string_view per) {
  return fmt::format("{} {}{}", significant(si / unit_value(quantity, units), digits), unit_name(quantity, units), per);
}

std::string in_words(const Certificate& certificate) {
  std::string text = to_string(certificate.stability);
  const auto add = [&](int number, const std::string& what) {
    if (number > 0) text += ", " + count(number, what + " direction", what + " directions");
  };
  add(certificate.unstable_directions, "unstable");
  add(certificate.neutral_directions, "neutral");
  return text;
}

std::string shaky_in_words(const Freedoms& freedoms) {
  if (!freedoms.is_shaky()) return "";
  const std::string finite = *freedoms.finite == 0 ? "none" : std::to_string(*freedoms.finite);
  const std::string known = freedoms.by == Freedoms::By::curvature
                                ? "to second order they would open along every motion"
                                : "found by closing the loops again at places beside it, which is no proof";
  return fmt::format(
      "joints repeat each other in this position and not beside it: {} of infinitesimal motion, {} of "
      "finite motion ({})",
      count(freedoms.infinitesimal, "degree of freedom", "degrees of freedom"), finite, known);
}

void warn_of_shaky(Result& result, const std::string& where, const std::vector<Answer>& answers,
                   const std::vector<std::string>& names) {
  std::vector<std::pair<std::string, std::vector<std::string>>> said;  // words, and the answers that they are about
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (!answers[k].freedoms || !answers[k].freedoms->is_shaky()) continue;
    const std::string words = shaky_in_words(*answers[k].freedoms);
    auto same = std::find_if(said.begin(), said.end(), [&](const auto& one) { return one.first == words; });
    if (same == said.end()) same = said.insert(same, {words, {}});
    if (!names.empty()) same->second.push_back(names[k]);
  }
  for (const auto& [words, about] : said) {
    const std::string place = about.empty() ? where : fmt::format("{} {}:", where, fmt::join(about, ", "));
    result.warnings.push_back(doubtful(fmt::format("{} {}.", place, words)));
  }
}

void add_freedoms(Group& group, const Freedoms& freedoms) {
  group.data("degrees_of_freedom", freedoms.infinitesimal);
  group.data("finite_degrees_of_freedom", freedoms.finite);
  group.data("known_by", to_string(freedoms.by));
}

void add_mobility(Group& group, const std::optional<Freedoms>& freedoms) {
  if (!freedoms) {
    group.data("mobility", nullptr);
    return;
  }
  add_freedoms(group.group("mobility", "", Verbosity::data), *freedoms);
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

std::string stability_and_energy(const ScaledModel& model, const Equilibrium& equilibrium) {
  std::string text = to_string(equilibrium.certificate.stability);
  if (equilibrium.energy) text += ", " + with_unit(model, *equilibrium.energy, Quantity::energy, 5);
  return text;
}

std::vector<double>::const_iterator largest_by_size(const std::vector<double>& values) {
  // Not a number is the least of all.
  const auto size = [](double v) { return std::isnan(v) ? -1.0 : std::abs(v); };
  return std::max_element(values.begin(), values.end(), [&](double a, double b) { return size(a) < size(b); });
}

double largest_size(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double v : values) {
    if (!std::isnan(v)) largest = std::max(largest, std::abs(v));
  }
  return largest;
}

std::string second_body(const Scene& scene, const Measure& on) {
  switch (on.kind) {
    case Measure::Kind::angle:
      return scene.bodies[on.body_b].name;
    case Measure::Kind::travel:
      return scene.bodies[scene.joints[on.joint].b.body].name;
    case Measure::Kind::distance:
    case Measure::Kind::component:
    case Measure::Kind::clearance:
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
    case Measure::Kind::x:
    case Measure::Kind::y:
      return scene.bodies[on.b.body].name;
    case Measure::Kind::rope:
      return scene.bodies[on.contacts.back().at.body].name;
    case Measure::Kind::sum:
      break;
  }
  return on.terms.empty() ? "" : second_body(scene, on.terms.front().measure);
}

NamedRows rigid_rows(const Scene& scene, const std::vector<std::string>& bodies) {
  const std::vector<int> groups = rigid_groups(scene);
  std::unordered_map<std::string, int> group_of;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) group_of.emplace(scene.bodies[i].name, groups[i]);
  std::unordered_map<int, std::size_t> row_of;
  NamedRows rows;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto [row, is_new] = row_of.emplace(group_of.at(bodies[i]), rows.places.size());
    if (is_new) {
      rows.places.push_back(i);
      rows.names.push_back(bodies[i]);
    } else {
      rows.names[row->second] += ", " + bodies[i];
    }
  }
  return rows;
}

void add_coordinates(Group& group, const StaticModel& model, const std::vector<const Readings*>& poses,
                     const std::vector<std::string>& titles, double radius) {
  if (poses.empty()) return;
  std::vector<std::vector<NamedValue>> angles, travels, places;
  for (const Readings* pose : poses) {
    angles.push_back(angles_of(model, *pose));
    travels.push_back(travels_of(model, *pose));
    places.push_back(places_of(model, *pose));
  }
  add_values(group, model, "Angles", "body", Quantity::angle,
             rigid_rows(model.scene(), each(angles.front(), &NamedValue::name)), angles, titles, radius);
  add_values(group, model, "Slides", "joint", Quantity::length, all_rows(travels.front()), travels, titles, radius);
  add_values(group, model, "Positions of free bodies", "body", Quantity::length, all_rows(places.front()), places,
             titles, radius);
}

Quantity quantity_of(const Coordinate& coordinate) {
  return coordinate.kind == Coordinate::Kind::angle ? Quantity::angle : Quantity::length;
}

std::vector<double> shown_coordinates(const StaticModel& model, const std::vector<double>& x) {
  std::vector<double> q = model.to_si(x);
  std::map<std::string, double> in_world;
  for (const NamedValue& place : places_of(model, read_off(model, x))) in_world[place.name] = place.value;
  for (std::size_t i = 0; i < q.size(); ++i) {
    const auto place = in_world.find(model.layout().coordinates[i].name);
    if (place != in_world.end()) q[i] = place->second;
  }
  return q;
}

void add_coordinate_data(Group& group, const std::string& key, const StaticModel& model, const std::vector<double>& x) {
  Group& pose = group.group(key, "", Verbosity::data);
  const std::vector<double> q = shown_coordinates(model, x);
  for (std::size_t i = 0; i < q.size(); ++i) {
    const Coordinate& coordinate = model.layout().coordinates[i];
    pose.data(coordinate.name, in_unit(q[i], quantity_of(coordinate), model.scene().units));
  }
}

Table& add_coordinate_names(Table& table, const Layout& layout, std::size_t number) {
  const std::vector<std::size_t> rows = places(number);
  table.words("name", "", each(rows, [&](std::size_t i) { return layout.coordinates[i].name; }));
  table.words("unit", "", each(rows, [&](std::size_t i) {
                return layout.coordinates[i].kind == Coordinate::Kind::angle ? "rad" : "m";
              }));
  return table;
}

std::vector<Reaction> reaction_rows(const std::vector<Reaction>& reactions) {
  std::vector<Reaction> out;
  for (const Reaction& reaction : reactions) {
    if (reaction.parts.empty()) out.push_back(reaction);
    for (const BodyForce& part : reaction.parts) {
      Reaction& row = out.emplace_back(reaction);
      row.parts.clear();
      row.body_a = row.body_b = part.body;
      row.at = part.at;
      row.force = part.force;
      row.moment = part.moment;
      row.radius = part.radius;
      row.moment_radius = part.moment_radius;
    }
  }
  return out;
}

Table& add_reactions(Group& group, const ScaledModel& model, const std::vector<Reaction>& reactions, int redundancy,
                     Verbosity level) {
  const Units& units = model.scene().units;
  const auto is_axial = [](const Reaction& r) { return r.kind == "bar" || r.axial != 0.0; };
  const auto any = [&](auto&& is) { return std::any_of(reactions.begin(), reactions.end(), is); };
  const std::vector<double> sizes = each(reactions, [](const Reaction& r) { return norm(r.force); });
  const double largest = sizes.empty() ? 0.0 : *std::max_element(sizes.begin(), sizes.end());
  const double radius = widest(each(reactions, &Reaction::radius));
  const std::vector<double> moments = each(reactions, &Reaction::moment);
  const std::string heading =
      any([](const Reaction& r) { return r.of_stop(); }) ? "Forces of joints and active stops" : "Joint forces";
  Table& table = group.table("reactions", heading + " on the named body, along world axes", Rows::list, level);
  table.words("name", "joint", each(reactions, &Reaction::name));
  table.words("kind", "kind", each(reactions, &Reaction::kind));
  table.words("on", "on", each(reactions, [&](const Reaction& r) {
                return model.scene().bodies[static_cast<std::size_t>(r.body_b)].name;
              }));
  // A rope, a cam or teeth act on a body from several sides.
  Column& by = table.words("by", "", each(reactions, [&](const Reaction& r) {
                             const auto body = static_cast<std::size_t>(r.body_a);
                             return r.body_a == r.body_b ? "" : model.scene().bodies[body].name;
                           }));
  by.kind = Column::Kind::word_or_null;
  by.shown = false;
  const auto length = [&](double si) { return in_unit(si, Quantity::length, units); };
  table.data("at[]", each(reactions, [&](const Reaction& r) { return length(r.at.x); }));
  table.data("at[]", each(reactions, [&](const Reaction& r) { return length(r.at.y); }));
  const auto add_force = [&](const std::string& key, const std::string& title, const std::vector<double>& values) {
    add_column(table, model, key, title, Quantity::force, values, force_digits, radius).format.scale =
        in_unit(largest, Quantity::force, units);
  };
  add_force("force[]", "Fx", each(reactions, [](const Reaction& r) { return r.force.x; }));
  add_force("force[]", "Fy", each(reactions, [](const Reaction& r) { return r.force.y; }));
  add_force("", "|F|", sizes);
  const double rounding = format_of(model, Quantity::moment, force_digits).zero_below;
  add_column(table, model, "moment", "moment", Quantity::moment, moments, force_digits,
             widest(each(reactions, &Reaction::moment_radius)))
      .shown = any([&](const Reaction& r) { return std::abs(in_unit(r.moment, Quantity::moment, units)) > rounding; });
  table.data("axial", in_unit(each(reactions, &Reaction::axial), Quantity::force, units));
  add_column(table, model, "", "tension", Quantity::force,
             each(reactions, [&](const Reaction& r) { return is_axial(r) ? r.axial : NAN; }), force_digits, radius)
      .shown = any(is_axial);
  table.flags("determined", each(reactions, &Reaction::determined));
  table.flags("may_be_idle", each(reactions, [](const Reaction& r) {
                return r.may_be_idle ? std::optional<double>(*r.may_be_idle ? 1.0 : 0.0) : std::nullopt;
              }));
  const auto is_proved = [](const Reaction& r) { return std::isfinite(r.radius) && std::isfinite(r.moment_radius); };
  const bool some_are_proved = any(is_proved);
  table.remarks(each(reactions,
                     [&](const Reaction& r) {
                       std::string undetermined = r.determined                     ? ""
                                                  : !r.may_be_idle.value_or(false) ? "undetermined"
                                                  : r.kind == "rope"               ? "undetermined, slack possible"
                                                                                   : "undetermined, may carry nothing";
                       if (!some_are_proved || is_proved(r)) return undetermined;
                       return undetermined + (r.determined ? "" : ", ") + "digits not proved";
                     }),
                Tone::doubtful);
  if (redundancy > 0) {
    table.footnotes.push_back(count(redundancy, "state of self-stress", "states of self-stress") +
                              ": statics does not determine the marked forces; shown are those of minimum norm" +
                              (any([](const Reaction& r) { return r.of_stop() && !r.determined; })
                                   ? " with which ropes pull and stops push"
                                   : ""));
  }
  return table;
}

void add_forces_on_bodies(Group& group, const ScaledModel& model,
                          const std::vector<std::vector<SourcedForce>>& positions) {
  const Scene& scene = model.scene();
  std::vector<SourcedForce> all;
  std::vector<double> position;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    all.insert(all.end(), positions[k].begin(), positions[k].end());
    position.resize(all.size(), static_cast<double>(k));
  }
  Table& table = group.table("forces_on_bodies", "", Rows::list, Verbosity::data);
  if (positions.size() > 1) table.counts("position", "", position);
  table.words("body", "",
              each(all, [&](const SourcedForce& f) { return scene.bodies[static_cast<std::size_t>(f.on.body)].name; }));
  table.words("kind", "", each(all, &SourcedForce::kind));
  table.words("name", "", each(all, &SourcedForce::name));
  const auto add = [&](const std::string& key, Quantity quantity, auto&& value) {
    table.data(key, in_unit(each(all, [&](const SourcedForce& f) { return value(f.on); }), quantity, scene.units));
  };
  add("at[]", Quantity::length, [](const BodyForce& f) { return f.at.x; });
  add("at[]", Quantity::length, [](const BodyForce& f) { return f.at.y; });
  add("force[]", Quantity::force, [](const BodyForce& f) { return f.force.x; });
  add("force[]", Quantity::force, [](const BodyForce& f) { return f.force.y; });
  add("moment", Quantity::moment, [](const BodyForce& f) { return f.moment; });
}

void add_forces_on_bodies(Group& group, const ScaledModel& model, const std::vector<BodyPose<double>>& poses,
                          const Check& check) {
  const Scene& scene = model.scene();
  if (check.element_forces.size() != scene.elements.size()) {
    group.data("forces_on_bodies", nullptr);
    return;
  }
  add_forces_on_bodies(
      group, model,
      {forces_on_bodies(scene, poses, each(check.element_forces, &ElementForce::value), check.reactions)});
}

double widest(const std::vector<double>& radii) {
  double out = 0.0;
  for (const double radius : radii) {
    if (std::isfinite(radius)) out = std::max(out, radius);
  }
  return out;
}

void warn_of_friction(Result& result, const Scene& scene) {
  std::vector<std::string> names;
  for (const Element& element : scene.elements) {
    const auto* friction = std::get_if<DryFriction>(&element.law);
    if (friction != nullptr && friction->force != 0.0) names.push_back("\"" + element.name + "\"");
  }
  for (std::string& joint : joints_with_friction(scene)) names.push_back(std::move(joint));
  for (const Stop& rope : scene.stops) {
    if (!rubbing_rims(rope.on).empty()) names.push_back("\"" + rope.name + "\"");
  }
  for (const Stop& stop : scene.stops) {
    // The parts of a contact share their name.
    if (stop.friction.value_or(0.0) != 0.0 && !stop.table.starts_with("contact_part")) {
      names.push_back("\"" + stop.name + "\"");
    }
  }
  if (names.empty()) return;
  result.warnings.push_back(
      doubtful(fmt::format("Dry friction is left out: {} may hold the mechanism elsewhere too.", listed(names))));
}

void warn_of_blades(Result& result, const Scene& scene) {
  if (scene.blades.empty()) return;
  const std::vector<std::string> names =
      each(scene.blades, [](const Blade& blade) { return "\"" + blade.name + "\""; });
  const bool one = names.size() == 1;
  result.warnings.push_back(doubtful(fmt::format(
      "{} {} {} across {} at rest too, so that positions in balance come in sets: this is the one without {}, and its "
      "stability is that without {}.",
      one ? "Blade" : "Blades", listed(names), one ? "can take a force" : "can take forces",
      one ? "its edge" : "their edges", one ? "that force" : "those forces", one ? "the blade" : "the blades")));
}

double radius_of(const Equilibrium& equilibrium) {
  return equilibrium.certificate.confirmed() ? equilibrium.certificate.radius : 0.0;
}

Format format_of_energies(const ScaledModel& model, std::span<const Answer> answers, Format::Style style) {
  double radius = 0.0;
  for (const Answer& answer : answers) {
    if (answer.equilibrium.energy && answer.equilibrium.found()) radius = std::max(radius, answer.radii.energy);
  }
  return format_of(model, Quantity::energy, coordinate_digits, style, radius);
}

std::string sentence_of(std::string text) {
  if (!text.empty()) text.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(text.front())));
  return text.ends_with('.') ? text : text + ".";
}

void warn_of_unloaded_bearings(Result& result, const Scene& scene) {
  const bool rubs = std::any_of(scene.joints.begin(), scene.joints.end(),
                                [](const Joint& joint) { return joint.friction && joint.friction->coefficient > 0.0; });
  if (!rubs) return;
  std::vector<std::string> names;
  std::set<std::string> keys;
  for (const Stop& stop : scene.stops) {
    if (!transmits(stop) || loads_bearings(stop)) continue;
    names.push_back("\"" + stop.name + "\"");
    if (stop.table == "gear" || stop.table == "rack") keys.insert("pressure_angle");
    if (stop.table == "cam") keys.insert("roller");
  }
  if (names.empty()) return;
  const std::string advice =
      keys.empty() ? "" : fmt::format(" Where they touch the scene says by the key {}.", fmt::join(keys, " or "));
  result.warnings.push_back(doubtful(
      fmt::format("Friction leaves out how teeth and contacts of {} press on bearings and guides: these act on their "
                  "measures alone.{}",
                  listed(names), advice)));
}

}  // namespace poise::app
