#include <algorithm>
#include <cmath>
#include <string_view>
#include <unordered_map>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

constexpr double negligible = 1e-9;  ///< part of the largest force below which nothing is drawn

struct Arrow {
  Vec2 tail, tip;
};

/// An arrow of a force at a place: it either leaves the place or points at it, whichever crosses less.
Arrow place_arrow(const Stage& stage, Vec2 at, Vec2 force, double preference_to_leave) {
  constexpr double clearance = 5.0;
  const double size = norm(force);
  const Vec2 u = stage.page_direction((1 / size) * force);
  const double length = stage.arrow_length(size);
  const double gap = stage.pin_radius + 2.0;
  const Arrow leaves{at + gap * u, at + (gap + length) * u};
  const Arrow arrives{at - (gap + length) * u, at - gap * u};
  const double leaving = stage.setter.covered(leaves.tail, leaves.tip, clearance);
  const double arriving = stage.setter.covered(arrives.tip, arrives.tail, clearance);
  return leaving <= arriving + preference_to_leave ? leaves : arrives;
}

/// Moves an arrow aside where it would lie on one that is drawn already.
Arrow beside_others(const Stage& stage, Arrow arrow) {
  constexpr double spacing = 7.0;
  const Vec2 d = arrow.tip - arrow.tail;
  const Vec2 u = (1 / norm(d)) * d;
  for (const auto& [tail, tip] : stage.arrows) {
    const Vec2 other = (1 / norm(tip - tail)) * (tip - tail);
    const Vec2 apart = 0.5 * (tip + tail) - 0.5 * (arrow.tip + arrow.tail);
    const bool same_line = std::abs(cross(u, other)) < 0.1 && std::abs(cross(u, apart)) < spacing;
    if (!same_line || std::abs(dot(u, apart)) > 0.5 * (norm(d) + norm(tip - tail))) continue;
    const Vec2 aside = spacing * quarter_turn(u);
    arrow = {arrow.tail + aside, arrow.tip + aside};
  }
  return arrow;
}

/// Draws the arrow with its label at its far end.
void draw_force(Stage& stage, Vec2 at, Arrow arrow, const std::string& text, const std::string& colour, double width,
                const std::string& dash) {
  arrow = beside_others(stage, arrow);
  stage.arrows.emplace_back(arrow.tail, arrow.tip);
  draw_arrow(stage.canvas, arrow.tail, arrow.tip, colour, width, dash);
  stage.setter.avoid(arrow.tail, arrow.tip, width + 6);
  if (text.empty()) return;
  const Vec2 far = norm(arrow.tip - at) > norm(arrow.tail - at) ? arrow.tip : arrow.tail;
  stage.label(text, far, (1 / norm(far - at)) * (far - at), 4, colour);
}

void draw_turning(Stage& stage, Vec2 at, double radius, double moment, const std::string& text,
                  const std::string& colour, double width, const std::string& dash = "") {
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
  const std::string colour = ink::reaction;
  const Vec2 at = stage.page(reaction.at);
  const std::string mark = reaction.determined ? "" : "*";
  if (joint.keeps_length()) {
    if (std::abs(reaction.axial) <= negligible * stage.largest_force) return;
    const Vec2 a = stage.page(joint.a);
    const Vec2 b = stage.page(joint.b);
    Vec2 beside = quarter_turn(b - a);
    if (beside.y > 0) beside = -beside;
    const std::string name = stage.short_name(joint);
    stage.label((name.empty() ? "" : name + " = ") + stage.value(reaction.axial, Quantity::force) + mark, 0.5 * (a + b),
                beside, 0.5 * stage.bar_width + 4, colour);
    stage.signs.insert(reaction.determined ? Sign::reaction : Sign::undetermined_reaction);
    return;
  }
  // The force on the body that moves.
  const Vec2 force = joint.b.body == 0 ? -reaction.force : reaction.force;
  const double moment = joint.b.body == 0 ? -reaction.moment : reaction.moment;
  const double size = norm(force);
  const bool has_force = size > negligible * stage.largest_force;
  const bool has_moment = std::abs(moment) > negligible * stage.largest_force * stage.model.scales().length;
  if (!has_force && !has_moment) return;
  stage.signs.insert(reaction.determined ? Sign::reaction : Sign::undetermined_reaction);
  const std::string dash = reaction.determined ? "" : "4 3";
  const double width = at_ground ? 1.5 : 1.0;
  if (has_force) {
    draw_force(stage, at, place_arrow(stage, at, force, 4.0), stage.value(size, Quantity::force) + mark, colour, width,
               dash);
  }
  if (has_moment) {
    draw_turning(stage, at, 17.0, moment, stage.value(std::abs(moment), Quantity::moment) + mark, colour, width, dash);
  }
}

}  // namespace

void draw_loads(Stage& stage) {
  stage.canvas.open("loads");
  const bool named = stage.detail != Detail::sketch || stage.scene.forces.size() <= 12;
  for (const Force& force : stage.scene.forces) {
    const double size = norm(force.vector);
    if (size == 0.0) continue;
    const Vec2 at = stage.page(force.at);
    const Vec2 now = force.follows < 0 ? force.vector : force.vector * unit(stage.now.poses[force.follows].angle);
    std::string text;
    if (named) text = force.name + " = " + stage.value(size, Quantity::force);
    if (named && force.follows >= 0) text += ", follows " + stage.scene.bodies[force.follows].name;
    draw_force(stage, at, place_arrow(stage, at, now, 15.0), text, ink::load, 2.4, "");
    stage.signs.insert(Sign::load);
  }
  for (const Torque& torque : stage.scene.torques) {
    if (torque.value == 0.0 || torque.body == 0) continue;
    const std::string text =
        named ? torque.name + " = " + stage.value(std::abs(torque.value), Quantity::moment) : std::string();
    draw_turning(stage, held_at(stage, torque.body), 24.0, torque.value, text, ink::load, 2.2);
    stage.signs.insert(Sign::load);
  }
  stage.canvas.close();
}

void draw_reactions(Stage& stage) {
  if (!stage.shows_ground) return;
  std::unordered_map<std::string_view, const Joint*> joints;
  for (const Joint& joint : stage.scene.joints) joints.emplace(joint.name, &joint);
  stage.canvas.open("reactions");
  for (const Reaction& reaction : stage.rest.check.reactions) {
    const auto joint = joints.find(reaction.name);
    if (reaction.kind != "stop" && joint != joints.end()) draw_reaction(stage, reaction, *joint->second);
  }
  stage.canvas.close();
}

}  // namespace poise::app
