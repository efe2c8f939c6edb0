#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"
#include "model/curved_slots.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise::app {
namespace {

constexpr double negligible_force = 1e-9;    ///< part of the largest force below which nothing is drawn
constexpr double covered_for_change = 40.0;  ///< px covered for which an arrow stays as it was in the picture before

struct Arrow {
  Vec2 tail, tip;
};

/// The arrow of a force that starts where the force acts.
Arrow leaving(const Stage& stage, Vec2 at, Vec2 force) {
  const double size = norm(force);
  const Vec2 u = stage.page_direction((1 / size) * force);
  return {at + stage.pin_radius * u, at + (stage.pin_radius + stage.arrow_length(size)) * u};
}

/// How much of what is drawn an arrow from a place runs along, px.
double covered_by(const Stage& stage, Vec2 at, const Arrow& arrow) {
  constexpr double clearance = 5.0;
  // Cosine of the angle to a member from which on an arrow seems to lie on it, and what lying on it counts.
  constexpr double seems_to_lie = 0.7;
  constexpr double on_member = 60.0;
  const Vec2 u = (1 / norm(arrow.tip - arrow.tail)) * (arrow.tip - arrow.tail);
  double nearest = seems_to_lie;
  if (stage.detail != Detail::sketch) {
    for (const Vec2& member : stage.members_at(at)) nearest = std::max(nearest, dot(member, u));
  }
  return stage.setter.covered(arrow.tail, arrow.tip, clearance) +
         on_member * (nearest - seems_to_lie) / (1 - seems_to_lie);
}

/// The arrow of a load starts at its point, or ends there where it would otherwise run along what is drawn; moved aside
/// where the arrow of a joint force is there already.
Arrow place_load(const Stage& stage, Vec2 at, Vec2 force) {
  constexpr double preference = 15.0;
  constexpr double spacing = 7.0;
  Arrow arrow = leaving(stage, at, force);
  if (stage.detail == Detail::sketch) return arrow;
  const Arrow opposite = leaving(stage, at, -force);
  const double ending = covered_by(stage, at, opposite) + preference;
  if (stage.least(stage.canvas.current().name, {covered_by(stage, at, arrow), ending}, covered_for_change) == 1)
    arrow = {opposite.tip, opposite.tail};
  const Vec2 u = (1 / norm(arrow.tip - arrow.tail)) * (arrow.tip - arrow.tail);
  for (const auto& [tail, tip] : stage.arrows) {
    const Vec2 other = (1 / norm(tip - tail)) * (tip - tail);
    const Vec2 apart = 0.5 * (tip + tail) - 0.5 * (arrow.tip + arrow.tail);
    const bool same_line = std::abs(cross(u, other)) < 0.1 && std::abs(cross(u, apart)) < spacing;
    if (!same_line || std::abs(dot(u, apart)) > 0.5 * (norm(arrow.tip - arrow.tail) + norm(tip - tail))) continue;
    const Vec2 aside = spacing * quarter_turn(u);
    arrow = {arrow.tail + aside, arrow.tip + aside};
  }
  return arrow;
}

/// Draws the arrow with its label at its end away from `at`.
void draw_force(Stage& stage, Vec2 at, const Arrow& arrow, const std::string& text, Colour colour, double width,
                std::string_view dash) {
  draw_arrow(stage.canvas, arrow.tail, arrow.tip, colour, width, dash);
  stage.arrows.emplace_back(arrow.tail, arrow.tip);
  stage.setter.avoid(arrow.tail, arrow.tip, width + 6);
  if (text.empty()) return;
  const Vec2 far = norm(arrow.tip - at) > norm(arrow.tail - at) ? arrow.tip : arrow.tail;
  stage.label(text, far, (1 / norm(far - at)) * (far - at), 4, colour);
}

void draw_turning(Stage& stage, Vec2 at, double radius, double moment, const std::string& text, Colour colour,
                  double width, std::string_view dash = {}) {
  draw_turning_arrow(stage.canvas, at, radius, {0.5, 0.866}, moment > 0, colour, width, dash);
  stage.setter.avoid(at, radius);
  if (!text.empty()) stage.label(text, at, {-0.7, -0.7}, radius + 4, colour);
}

/// Where a body is held: its joint with the ground, else its first joint, else its origin.
Vec2 held_at(const Stage& stage, int body) {
  const Joint* held = nullptr;
  for (const Joint& joint : stage.scene.joints) {
    if (joint.a.body != body && joint.b.body != body) continue;
    const bool to_ground = joint.a.body == 0 || joint.b.body == 0;
    if (held == nullptr || to_ground) held = &joint;
    if (to_ground) break;
  }
  if (held == nullptr) return stage.page(stage.now.poses[body].origin);
  return stage.page(held->a.body == body ? held->a : held->b);
}

void draw_reaction(Stage& stage, const Reaction& reaction, const Joint& joint) {
  const bool at_ground = joint.a.body == 0 || joint.b.body == 0;
  if (stage.detail != Detail::full && !at_ground) return;
  const Colour colour = ink::reaction;
  const Vec2 at = stage.page(reaction.at);
  const std::string mark = reaction.determined ? "" : "*";
  const std::string item = "force of " + Stage::item_of(joint);
  if (joint.keeps_length()) {
    if (std::abs(reaction.axial) <= negligible_force * stage.largest_force) return;
    const Vec2 a = stage.page(joint.a);
    const Vec2 b = stage.page(joint.b);
    Vec2 beside = quarter_turn(b - a);
    if (beside.y > 0) beside = -beside;
    const std::string name = stage.short_name(joint);
    stage.canvas.item(item, stage.value(reaction.axial, Quantity::force, reaction.radius) + mark);
    stage.label(
        (name.empty() ? "" : name + " = ") + stage.value(reaction.axial, Quantity::force, reaction.radius) + mark,
        0.5 * (a + b), beside, 0.5 * stage.bar_width + 4, colour);
    if (!reaction.determined) stage.signs.insert(Sign::undetermined_reaction);
    return;
  }
  const double size = norm(reaction.force);
  const bool has_force = size > negligible_force * stage.largest_force;
  const bool has_moment = std::abs(reaction.moment) > negligible_force * stage.largest_force * stage.extent;
  if (!has_force && !has_moment) return;
  stage.signs.insert(reaction.determined ? Sign::reaction : Sign::undetermined_reaction);
  const std::string_view dash = reaction.determined ? "" : "4 3";
  const double width = at_ground ? 1.5 : 1.0;
  const std::string name = stage.short_name(joint);
  const auto shown = [&](double value, Quantity quantity) {
    return stage.value(value, quantity, quantity == Quantity::force ? reaction.radius : reaction.moment_radius) + mark;
  };
  // Pictures show the force on the second body of the joint, as tables do.
  const std::string& on = stage.scene.bodies[static_cast<std::size_t>(joint.b.body)].name;
  const std::string& by = stage.scene.bodies[static_cast<std::size_t>(joint.a.body)].name;
  const auto text = [&](double value, Quantity quantity) {
    return (name.empty() ? "" : name + ": ") + shown(value, quantity) + " on " + on;
  };
  const auto both = [&](double value, Quantity quantity) {
    return fmt::format("{} on {} by {}, as much back on {} by {}", shown(value, quantity), on, by, by, on);
  };
  if (has_force) {
    stage.canvas.item(item, both(size, Quantity::force));
    draw_force(stage, at, leaving(stage, at, reaction.force), text(size, Quantity::force), colour, width, dash);
  }
  if (has_moment) {
    const double moment = std::abs(reaction.moment);
    stage.canvas.item("moment of " + Stage::item_of(joint), both(moment, Quantity::moment));
    draw_turning(stage, at, 17.0, reaction.moment, text(moment, Quantity::moment), colour, width, dash);
  }
}

/// The force of a blade on the body of its point.
void draw_force_of_blade(Stage& stage, const Reaction& reaction) {
  const double size = norm(reaction.force);
  if (size <= negligible_force * stage.largest_force) return;
  stage.signs.insert(reaction.determined ? Sign::reaction : Sign::undetermined_reaction);
  const std::string value = stage.value(size, Quantity::force, reaction.radius) + (reaction.determined ? "" : "*");
  const std::string& on = stage.scene.bodies[static_cast<std::size_t>(reaction.body_b)].name;
  stage.canvas.item("force of blade " + reaction.name, value + " on " + on);
  draw_force(stage, stage.page(reaction.at), leaving(stage, stage.page(reaction.at), reaction.force),
             fmt::format("{}: {} on {}", reaction.name, value, on), ink::reaction, 1.5,
             reaction.determined ? "" : "4 3");
}

/// The effort of a drive on the second body of its measure.
void draw_drive(Stage& stage, const DriveEffort& effort, const Drive& drive) {
  if (effort.value == 0.0) return;
  stage.signs.insert(Sign::drive);
  const Quantity quantity = effort.is_angle ? Quantity::moment : Quantity::force;
  const std::string text =
      effort.name + " = " + stage.value(std::abs(effort.value), quantity) + (effort.determined ? "" : "*");
  stage.canvas.item("drive " + effort.name, stage.value(effort.value, quantity));
  const std::vector<UnitEffort> units = unit_efforts(stage.scene, drive.on, stage.now.poses);
  if (effort.is_angle) {
    for (const UnitEffort& unit : units) {
      draw_turning(stage, stage.pivot(unit.body_a, unit.body_b), 27.0, effort.value * unit.moment, text, ink::drive,
                   2.0);
    }
    return;
  }
  // Terms of a sum that push at one point push together.
  for (auto unit = units.begin(); unit != units.end(); ++unit) {
    const auto is_there = [&](const UnitEffort& other) { return other.body_b == unit->body_b && other.b == unit->b; };
    if (std::any_of(units.begin(), unit, is_there)) continue;
    Vec2 force{};
    for (const UnitEffort& other : units) force = is_there(other) ? force + other.force : force;
    const Vec2 at = stage.page(unit->b);
    draw_force(stage, at, leaving(stage, at, effort.value * force), text, ink::drive, 2.0, "");
  }
}

/// "P = 3 N"; of a load that follows a function of time "P(t) = c(t) 3 N", or at one time "P(t = 0 s) = 3 N".
std::string load_text(const Stage& stage, TimeFunction::Of of, int item, const std::string& name,
                      const std::string& value) {
  const auto is_own = [&](const TimeFunction& one) { return one.of == of && one.item == item; };
  const std::vector<TimeFunction>& functions = stage.scene.time_functions;
  if (std::any_of(functions.begin(), functions.end(), is_own)) return name + "(t) = c(t) " + value;
  for (const HeldLoad& held : stage.scene.held_loads) {
    if (held.name == name) return fmt::format("{}(t = {} s) = {}", name, held.time, value);
  }
  return name + " = " + value;
}

/// A row of arrows that end on the line of a distributed load, with a line along their tails.
void draw_distributed(Stage& stage, const Force& force, Vec2 now, bool named) {
  constexpr double length = 20.0, spacing = 16.0;
  const Vec2 a = stage.page(force.at), b = stage.page(*force.to);
  const Vec2 back = (-length / norm(now)) * Stage::page_direction(now);
  const Dimension per_length = Force::distributed[0].dimension;
  const std::string text =
      significant(norm(now) / per_length.unit(stage.scene.units), 5) + " " + per_length.unit_name(stage.scene.units);
  stage.canvas.item("distributed load " + force.name, text);
  const int parts = std::clamp(static_cast<int>(norm(b - a) / spacing), 1, 40);
  for (int k = 0; k <= parts; ++k) {
    const Vec2 tip = a + (static_cast<double>(k) / parts) * (b - a);
    draw_arrow(stage.canvas, tip + back, tip, ink::load, 1.2);
  }
  stage.canvas.line(a + back, b + back, {.stroke = ink::load, .width = 1.2});
  stage.setter.avoid(a + back, b + back, 4.0);
  stage.setter.avoid(a + 0.5 * back, b + 0.5 * back, length);
  const Vec2 middle = 0.5 * (a + b) + back;
  const auto item = static_cast<int>(&force - stage.scene.forces.data());
  if (named)
    stage.label(load_text(stage, TimeFunction::Of::force, item, force.name, text), middle, (1 / length) * back, 4,
                ink::load);
  stage.signs.insert(Sign::load);
}

/// The forces of what is touched: in motion of all stops, at rest of contacts and of what has clearance.
std::vector<TouchingForce> touching_in(const Stage& stage) {
  std::vector<TouchingForce> out = stage.picture.touching;
  if (!stage.picture.reactions) return out;
  for (const Reaction& reaction : *stage.picture.reactions) {
    if (!reaction.of_stop() || static_cast<std::size_t>(reaction.stop) >= stage.scene.stops.size()) continue;
    const auto stop = static_cast<std::size_t>(reaction.stop);
    const std::string& table = stage.scene.stops[stop].table;
    if (!table.starts_with("contact") && !table.starts_with("loose_")) continue;
    out.push_back({.stop = stop,
                   .body_a = reaction.body_a,
                   .body_b = reaction.body_b,
                   .at = reaction.at,
                   .force = reaction.force,
                   .pressing = norm(reaction.force)});
  }
  return out;
}

}  // namespace

void draw_loads(Stage& stage) {
  if (!stage.picture.loads) return;
  stage.canvas.open("loads");
  const bool named = stage.detail != Detail::sketch || stage.scene.forces.size() <= 12;
  for (const Force& force : stage.scene.forces) {
    const double size = norm(force.vector);
    if (size == 0.0) continue;
    const Vec2 now = force.follows < 0 ? force.vector : force.vector * unit(stage.now.poses[force.follows].angle);
    if (force.to) {
      draw_distributed(stage, force, now, named);
      continue;
    }
    const Vec2 at = stage.page(force.at);
    stage.canvas.item("load " + force.name, stage.value(size, Quantity::force));
    std::string text;
    if (named) {
      text = load_text(stage, TimeFunction::Of::force, static_cast<int>(&force - stage.scene.forces.data()), force.name,
                       stage.value(size, Quantity::force));
    }
    if (named && force.follows >= 0) text += ", follows " + stage.scene.bodies[force.follows].name;
    draw_force(stage, at, place_load(stage, at, now), text, ink::load, 2.4, "");
    stage.signs.insert(Sign::load);
  }
  for (const Torque& torque : stage.scene.torques) {
    if (torque.value == 0.0 || torque.body == 0) continue;
    stage.canvas.item("torque " + torque.name, stage.value(torque.value, Quantity::moment));
    const std::string text =
        named ? load_text(stage, TimeFunction::Of::torque, static_cast<int>(&torque - stage.scene.torques.data()),
                          torque.name, stage.value(std::abs(torque.value), Quantity::moment))
              : std::string();
    draw_turning(stage, held_at(stage, torque.body), 24.0, torque.value, text, ink::load, 2.2);
    stage.signs.insert(Sign::load);
  }
  stage.canvas.close();
}

void draw_reactions(Stage& stage) {
  if (!stage.picture.reactions || !stage.shows_ground) return;
  stage.canvas.open("reactions");
  for (const Reaction& reaction : *stage.picture.reactions) {
    if (reaction.kind == "blade") draw_force_of_blade(stage, reaction);
    if (reaction.joint < 0) continue;
    const Joint& joint = stage.scene.joints[static_cast<std::size_t>(reaction.joint)];
    if (!is_of_track(stage.scene, joint)) draw_reaction(stage, reaction, joint);
  }
  stage.canvas.close();
}

void draw_contact_forces(Stage& stage) {
  const std::vector<TouchingForce> touching = touching_in(stage);
  if (touching.empty()) return;
  constexpr std::string_view layer = "contact-forces";
  stage.canvas.open(layer);
  stage.label_layer = layer;
  for (const TouchingForce& one : touching) {
    const Stop& stop = stage.scene.stops[one.stop];
    const std::string& on = stage.scene.bodies[static_cast<std::size_t>(one.body_b)].name;
    const std::string& by = stage.scene.bodies[static_cast<std::size_t>(one.body_a)].name;
    const double size = norm(one.force), moment = std::abs(one.moment);
    const auto item = [&](const std::string& what, const std::string& value) {
      stage.canvas.item(fmt::format("{} of {} {}", what, stop.family(), stop.name),
                        fmt::format("{} on {} by {}", value, on, by));
    };
    if (stop.on.is_angle()) {
      if (moment <= negligible_force * stage.largest_force * stage.extent) continue;
      item("moment", stage.value(moment, Quantity::moment));
      const std::string text = stage.detail == Detail::full ? stage.value(moment, Quantity::moment) : "";
      draw_turning(stage, stage.pivot(one.body_a, one.body_b), 21.0, one.moment, text, ink::stop, 1.8);
    } else {
      if (size <= negligible_force * stage.largest_force) continue;
      const bool rubs = std::abs(size - one.pressing) > negligible_force * size;
      item("force", stage.value(size, Quantity::force) +
                        (rubs ? fmt::format(", {} of it pressing,", stage.value(one.pressing, Quantity::force)) : ""));
      const Vec2 at = stage.page(one.at);
      // At rest the stop's own label says it.
      const bool is_said = stage.detail != Detail::full || stage.picture.reactions;
      const std::string text = is_said ? "" : stage.value(size, Quantity::force);
      draw_force(stage, at, leaving(stage, at, one.force), text, ink::stop, 1.8, "");
    }
    stage.signs.insert(Sign::contact_force);
  }
  stage.label_layer = {};
  stage.canvas.close();
}

void draw_impacts(Stage& stage) {
  constexpr double gap = 5.0, least = 6.0, growth = 16.0, fades_to = 0.25;  // px, and opacity
  if (stage.picture.impacts.empty()) return;
  stage.canvas.open("impacts");
  for (const ImpactSign& one : stage.picture.impacts) {
    const Stop& stop = stage.scene.stops[one.stop];
    stage.canvas.item(fmt::format("impact at {} {}", stop.family(), stop.name),
                      stage.value(one.impulse, effort_of(stop.on)) + " s");
    const double from = gap + growth * one.faded / 2;
    draw_burst(stage.canvas, stage.page(one.at), from, from + least + growth * std::sqrt(one.size),
               {.stroke = ink::stop, .width = 2.0, .opacity = 1.0 - (1.0 - fades_to) * one.faded});
    stage.signs.insert(Sign::impact);
  }
  stage.canvas.close();
}

void draw_drives(Stage& stage) {
  stage.canvas.open("drives");
  for (const DriveEffort& effort : stage.picture.drives) {
    for (const Drive& drive : stage.scene.drives) {
      if (drive.name == effort.name) draw_drive(stage, effort, drive);
    }
  }
  stage.canvas.close();
}

}  // namespace poise::app
