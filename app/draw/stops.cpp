#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"

namespace poise::app {
namespace {

struct Colours {
  Colour line;
  double width;
};

Colours colours(bool active) { return active ? Colours{ink::stop, 2.6} : Colours{ink::free_stop, 1.2}; }

/// A rope of its full length where forces are not shown.
bool may_be_taut(const Stage& stage, const Stop& rope, double length) {
  constexpr double rounding = 1e-9;
  return !stage.picture.reactions && length >= (1.0 - rounding) * rope.max;
}

std::string carried_by(const Stage& stage, const Stop& stop, const Reaction& reaction) {
  return stop.on.is_angle() ? stage.value(std::abs(reaction.moment), Quantity::moment, reaction.moment_radius)
                            : stage.value(norm(reaction.force), Quantity::force, reaction.radius);
}

/// The force of one that is touched in a motion, as a reaction; none where it is not.
std::optional<Reaction> touched_in_motion(const Stage& stage, std::size_t stop) {
  for (const TouchingForce& one : stage.picture.touching) {
    if (one.stop != stop) continue;
    Reaction out;
    out.force = one.force;
    out.moment = one.moment;
    out.radius = out.moment_radius = 0.0;
    return out;
  }
  return std::nullopt;
}

/// "20 deg, active, 12 N m".
std::string state_of(const Stage& stage, const Stop& stop, double now, const Reaction* active) {
  const std::string state = stage.reading(now, quantity_of(stop.on));
  return active == nullptr ? state : state + ", active, " + carried_by(stage, stop, *active);
}

void label_active(Stage& stage, const Stop& stop, const Reaction& reaction, Vec2 at, Vec2 toward, double gap) {
  // In motion they have arrows, which say it where they are pointed at.
  if (stage.detail != Detail::full || !stage.picture.reactions) return;
  stage.label(stop.name + ": " + carried_by(stage, stop, reaction) + (reaction.determined ? "" : "*"), at, toward, gap,
              ink::stop);
}

/// Direction on the page from a pivot to the end of a body that is farthest from it.
Vec2 hand_of(const Stage& stage, int body, Vec2 pivot) {
  Vec2 hand = stage.page_direction(unit(stage.now.poses[body].angle));
  double reach = 1.0;
  for (const Vec2& p : stage.points_of(body)) {
    if (norm(p - pivot) <= reach) continue;
    reach = norm(p - pivot);
    hand = (1 / reach) * (p - pivot);
  }
  return hand;
}

/// An arc over the range that a stop allows the moving body, with a mark at each limit.
void draw_angle_stop(Stage& stage, const Stop& stop, double now, const Reaction* active) {
  const int moving = stop.on.body_b != 0 ? stop.on.body_b : stop.on.body_a;
  const double sense = stop.on.body_b != 0 ? 1.0 : -1.0;
  const Vec2 pivot = stage.pivot(stop.on.body_a, stop.on.body_b);
  const double hand = seen_angle(hand_of(stage, moving, pivot));
  const double radius = 30.0;
  // A mark stands beside the bar that touches it: below the smallest angle, above the largest.
  const auto mark = [&](double limit, double side) {
    const Vec2 u = conj(unit(hand + sense * (limit - now)));
    const Vec2 aside = -side * sense * (0.5 * stage.bar_width + 2.0) * quarter_turn(u);
    const Colours c = colours(active != nullptr && limit == pressed_limit(stop, now).value);
    stage.canvas.line(pivot + (radius - 10) * u + aside, pivot + (radius + 10) * u + aside,
                      {.stroke = c.line, .width = c.width});
  };
  if (std::isfinite(stop.min) && std::isfinite(stop.max) && stop.max - stop.min < 2 * M_PI) {
    stage.canvas.arc(pivot, radius, hand + sense * (stop.min - now), hand + sense * (stop.max - now),
                     {.stroke = ink::free_stop, .width = 1.2, .dash = "2 3"});
  }
  if (std::isfinite(stop.min)) mark(stop.min, -1.0);
  if (std::isfinite(stop.max)) mark(stop.max, 1.0);
  if (active) label_active(stage, stop, *active, pivot + radius * conj(unit(hand)), conj(unit(hand)), 12);
}

void draw_distance_stop(Stage& stage, const Stop& stop, const Reaction* active) {
  const Vec2 a = stage.page(stop.on.a);
  const Vec2 b = stage.page(stop.on.b);
  const auto [colour, width] = colours(active != nullptr);
  stage.canvas.line(a, b, {.stroke = colour, .width = width, .dash = active ? "" : "2 4"});
  if (!active) return;
  stage.setter.avoid(a, b, width);
  label_active(stage, stop, *active, 0.5 * (a + b), {0, -1}, 5);
}

/// Whether a row of the same contact before this one has its outline, which another corner touches.
bool is_drawn_before(const Stop& stop) {
  const Stop* row = &stop;
  while (row->table != "contact") {
    --row;
    if (row->on.outline == stop.on.outline) return true;
  }
  return false;
}

/// The outline that the circle around a point touches, and the circle.
void draw_contact(Stage& stage, const Stop& stop, const Reaction* active) {
  const auto [colour, width] = colours(active != nullptr);
  const Outline& outline = stop.on.outline;
  if (outline.form == Outline::Form::polygon) {
    const auto index = static_cast<std::size_t>(&stop - stage.scene.stops.data());
    if (active != nullptr || !is_drawn_before(stop))
      for (const auto& [from, to] : edges_of_contact(stage.scene, index))
        stage.canvas.line(stage.page(from), stage.page(to), {.stroke = colour, .width = width});
  } else {
    std::vector<Vec2> way;
    for (const PointRef& point : outline.points) way.push_back(stage.page(point));
    const Vec2 centre = way[0], begin = way[1] - centre, end = way[2] - centre;
    // The page is mirrored: counter-clockwise there is clockwise here.
    const double sense = outline.form == Outline::Form::hollow_arc ? -1.0 : 1.0;
    double sweep = sense * std::atan2(cross(begin, end), dot(begin, end));
    if (sweep <= 0.0) sweep += 2 * M_PI;
    constexpr int pieces = 48;
    way.clear();
    for (int k = 0; k <= pieces; ++k) way.push_back(centre + begin * unit(sense * sweep * k / pieces));
    stage.canvas.polyline(std::move(way), {.stroke = colour, .width = width});
  }
  const Vec2 centre = stage.page(stop.on.b);
  const double radius = stage.scale * stop.min;
  if (radius > stage.pin_radius) stage.canvas.circle(centre, radius, {.stroke = colour, .width = width});
  if (active) label_active(stage, stop, *active, centre, {0, -1}, radius + 5);
}

/// The line on the page along which a length is limited: where it is zero, its direction, and how far what meets the
/// stop reaches beyond its place.
struct LimitedLine {
  Vec2 origin, along;
  double face = 0.0;  ///< px
};

LimitedLine guide_line(const Stage& stage, int j) {
  const Joint& joint = stage.scene.joints[j];
  const bool block = joint.kind == Joint::Kind::slide && stage.cylinder_of_joint(j) == nullptr;
  return {stage.page(joint.a), stage.page_axis(joint), block ? 18.0 : stage.pin_radius + 2};
}

/// Parallel to a world axis through a point whose coordinate on that axis is `now`.
LimitedLine world_line(const Stage& stage, PointRef point, double now, Vec2 axis) {
  const Vec2 along = stage.page_direction(axis);
  return {stage.page(point) - (stage.scale * now) * along, along, stage.pin_radius + 2};
}

/// Along an axis that turns with the body of its first point, through its second point.
LimitedLine component_line(const Stage& stage, const Measure& on) {
  const Vec2 axis = direction<double>(on.axis) * unit(stage.now.poses[static_cast<std::size_t>(on.a.body)].angle);
  const Vec2 along = stage.page_direction(axis);
  const Vec2 from = stage.page(on.a), to = stage.page(on.b);
  return {to - dot(to - from, along) * along, along, stage.pin_radius + 2};
}

/// Marks across the line, where the block's face would meet them.
void draw_line_stop(Stage& stage, const Stop& stop, const LimitedLine& line, double now, const Reaction* active) {
  const Vec2 across = quarter_turn(line.along);
  const auto mark = [&](double limit, double sign) {
    const bool touched = active != nullptr && limit == pressed_limit(stop, now).value;
    const Vec2 at = line.origin + (stage.scale * limit + sign * line.face) * line.along;
    const Colours c = colours(touched);
    stage.canvas.line(at - 12.0 * across, at + 12.0 * across, {.stroke = c.line, .width = 1.4 * c.width});
    if (touched) label_active(stage, stop, *active, at, sign * line.along, 8);
  };
  if (std::isfinite(stop.min)) mark(stop.min, -1.0);
  if (std::isfinite(stop.max)) mark(stop.max, 1.0);
}

/// A pin in a hole: as much wider than the pin as it is loose.
void draw_loose_pin(Stage& stage, const Stop& stop, const Reaction* active) {
  const auto [colour, width] = colours(active != nullptr);
  const Vec2 pin = stage.page(stop.on.b);
  stage.canvas.circle(stage.page(stop.on.a), stage.pin_radius + stage.scale * stop.max,
                      {.stroke = colour, .width = width});
  draw_pin(stage.canvas, pin, stage.pin_radius);
  if (active) label_active(stage, stop, *active, pin, {0, -1}, stage.pin_radius + 5);
}

/// A pin in a slot: as much wider than the pin as it is loose.
void draw_loose_slot(Stage& stage, const Stop& stop, double now, const Reaction* active) {
  constexpr double beyond = 24.0;  // px, to either side
  const LimitedLine line = component_line(stage, stop.on);
  const Vec2 along = quarter_turn(line.along);
  const double pin = dot(stage.page(stop.on.b) - stage.page(stop.on.a), along);
  const double half = stage.pin_radius + stage.scale * stop.max;
  const Vec2 from = line.origin - (std::max(pin, 0.0) + beyond) * along;
  const Vec2 to = line.origin + (std::max(-pin, 0.0) + beyond) * along;
  constexpr int pieces = 12;
  std::vector<Vec2> rim;
  for (const auto& [end, sign] : {std::pair(to, 1.0), std::pair(from, -1.0)}) {
    for (int k = 0; k <= pieces; ++k) {
      const Vec2 turned = unit(M_PI * k / pieces - M_PI / 2);
      rim.push_back(end + sign * half * (turned.x * along + turned.y * line.along));
    }
  }
  stage.canvas.polygon(std::move(rim), {.stroke = ink::free_stop, .width = 1.2});
  draw_pin(stage.canvas, stage.page(stop.on.b), stage.pin_radius);
  if (active == nullptr) return;
  const Vec2 side = (pressed_limit(stop, now).value > 0.0 ? half : -half) * line.along;
  stage.canvas.line(from + side, to + side, {.stroke = ink::stop, .width = 2.6});
  label_active(stage, stop, *active, line.origin + side, (1 / half) * side, 8);
}

/// Draws one in the state that is named, unless it has no place of its own.
void draw_stop(Stage& stage, const Stop& stop, double now, const Reaction* active, const std::string& state) {
  stage.canvas.item(stop.family() + " " + stop.name, state);
  switch (stop.on.kind) {
    case Measure::Kind::angle:
      draw_angle_stop(stage, stop, now, active);
      break;
    case Measure::Kind::distance:
      if (stop.table == "loose_pin")
        draw_loose_pin(stage, stop, active);
      else
        draw_distance_stop(stage, stop, active);
      break;
    case Measure::Kind::travel:
      draw_line_stop(stage, stop, guide_line(stage, stop.on.joint), now, active);
      break;
    case Measure::Kind::x:
      draw_line_stop(stage, stop, world_line(stage, stop.on.b, now, {1, 0}), now, active);
      break;
    case Measure::Kind::y:
      draw_line_stop(stage, stop, world_line(stage, stop.on.b, now, {0, 1}), now, active);
      break;
    case Measure::Kind::component:
      if (stop.table == "loose_slot")
        draw_loose_slot(stage, stop, now, active);
      else
        draw_line_stop(stage, stop, component_line(stage, stop.on), now, active);
      break;
    case Measure::Kind::rope:
      draw_rope(stage, stop, active != nullptr || may_be_taut(stage, stop, now));
      return;
    case Measure::Kind::clearance:
      draw_contact(stage, stop, active);
      break;
    case Measure::Kind::along_outline:
    case Measure::Kind::slip_on_cam:
      return;  // of friction, no stop
    case Measure::Kind::sum:
      if (stop.table != "stop") draw_coupling(stage, stop, active != nullptr);
      return;
  }
  stage.signs.insert(active ? Sign::active_stop : Sign::inactive_stop);
}

/// One that yields, as one that does not.
Stop rigid(const Element& element, const CompliantStop& law) {
  Stop out{.name = element.name, .on = element.on};
  if (law.has_min) out.min = law.min;
  if (law.has_max) out.max = law.max;
  return out;
}

}  // namespace

void draw_stops(Stage& stage) {
  const std::vector<Element>& elements = stage.scene.elements;
  const bool some_yield = std::any_of(elements.begin(), elements.end(), [](const Element& element) {
    return std::holds_alternative<CompliantStop>(element.law);
  });
  if (stage.detail == Detail::sketch || (stage.scene.stops.empty() && !some_yield)) return;
  stage.canvas.open("stops");
  for (std::size_t i = 0; i < stage.scene.stops.size(); ++i) {
    const Stop& stop = stage.scene.stops[i];
    if (has_track(stop)) continue;  // it is drawn behind the bodies
    const double now = stage.now.stops[i];
    const std::optional<Reaction> touched = touched_in_motion(stage, i);
    const Reaction* active = stage.picture.reactions ? reaction_of_stop(*stage.picture.reactions, i)
                             : touched               ? &*touched
                                                     : nullptr;
    draw_stop(stage, stop, now, active, state_of(stage, stop, now, active));
  }
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const auto* const law = std::get_if<CompliantStop>(&elements[i].law);
    if (law == nullptr) continue;
    const ElementReading& reading = stage.now.elements[i];
    std::string state = stage.reading(reading.value, quantity_of(elements[i].on));
    if (!reading.slack)
      state += ", pressed by " + stage.value(std::abs(reading.force), effort_of(elements[i].on), reading.radius);
    draw_stop(stage, rigid(elements[i], *law), reading.value, nullptr, state);
  }
  stage.canvas.close();
}

void draw_blades(Stage& stage) {
  if (stage.scene.blades.empty()) return;
  stage.canvas.open("blades");
  for (const Blade& blade : stage.scene.blades) {
    const bool full = stage.detail == Detail::full;
    const double half = full ? 15.0 : 7.0;
    const Vec2 at = stage.page(blade.at);
    const Vec2 along = conj(unit(stage.now.poses[static_cast<std::size_t>(blade.at.body)].angle + blade.angle));
    stage.canvas.item("blade " + blade.name, "");
    draw_blade(stage.canvas, at, along, half, ink::dark);
    stage.signs.insert(Sign::blade);
    if (!full) continue;
    stage.setter.avoid(at, half);
    stage.label(blade.name, at, quarter_turn(along), 8.0, ink::dark);
  }
  stage.canvas.close();
}

}  // namespace poise::app
