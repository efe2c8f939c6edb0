// Slots that are curved, wheels and profiles that roll on a line or a circle, and chains.

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/draw/stage.hpp"
#include "app/draw/symbols.hpp"
#include "model/curved_slots.hpp"
#include "model/rolling_profile.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise::app {
namespace {

/// Points along the track of a curved slot, m, of an open one between its ends. Behind the row of its ends are those of
/// the coordinates of its track.
std::vector<Vec2> points_of_track(const Scene& scene, const Readings& readings, std::size_t first) {
  const Stop& ends = scene.stops[first];
  const Measure::Term& x = scene.stops[first + 1].on.terms[1];
  const Measure::Term& y = scene.stops[first + 2].on.terms[1];
  const double from = x.profile->periodic() ? 0.0 : ends.min;
  const double to = x.profile->periodic() ? x.span : ends.max;
  const Measure& component = scene.stops[first + 1].on.terms[0].measure;
  const BodyPose<double>& pose = readings.poses[static_cast<std::size_t>(component.a.body)];
  constexpr int steps = 160;
  std::vector<Vec2> out;
  for (int k = 0; k <= steps; ++k) {
    const double u = (from + (to - from) * k / steps) / x.span;
    const Vec2 on_track{-x.factor * x.profile->at(u).value, -y.factor * y.profile->at(u).value};
    out.push_back(pose.world(scene.local(component.a) + on_track));
  }
  return out;
}

/// Where the curve of a profile that rolls, or of a contact of curves the first or the one that it is against, has its
/// point at u, m: it counts from where its rider begins.
Vec2 point_on_curve(const Scene& scene, const Readings& readings, std::size_t first, double u, bool is_against) {
  const Stop& tangent = scene.stops[first + (is_against ? 3 : 2)];
  const PointRef origin = scene.joints[static_cast<std::size_t>(travel_along_curve(tangent))].a;
  return readings.poses[static_cast<std::size_t>(origin.body)].world(
      scene.local(origin) + point_of_profile(&scene.stops[first], u, is_against));
}

/// Points along such a curve, m.
std::vector<Vec2> points_of_curve(const Scene& scene, const Readings& readings, std::size_t first,
                                  bool is_against = false) {
  const auto [from, to] = range_of_profile(scene, first);
  constexpr int steps = 160;
  std::vector<Vec2> out;
  for (int k = 0; k <= steps; ++k) {
    out.push_back(point_on_curve(scene, readings, first, from + (to - from) * k / steps, is_against));
  }
  return out;
}

/// Radii of the wheel and of the circle of rolling on a circle, m.
double wheel_of(const std::vector<Stop>& stops, std::size_t first) { return stops[first + 1].on.terms[1].factor; }

double circle_of(const std::vector<Stop>& stops, std::size_t first) {
  return stops[first].max - stops[first].sense * wheel_of(stops, first);
}

/// A band of the width of a pin between two edges.
void draw_band(Stage& stage, const std::vector<Vec2>& line, bool is_closed) {
  const double width = stage.detail == Detail::sketch ? 3.0 : 1.5 * stage.bar_width + 3.0;
  std::vector<Vec2> shown = line;
  if (is_closed) shown.push_back(line.front());
  stage.canvas.polyline(shown, {.stroke = ink::dark, .width = width + 2.2});
  stage.canvas.polyline(shown, {.stroke = ink::support, .width = width});
  for (std::size_t k = 1; k < shown.size(); ++k) stage.setter.avoid(shown[k - 1], shown[k], width);
}

/// What the rows of a contact carry, beside it; nothing where they carry none or the picture shows no forces.
void label_force(Stage& stage, const Stop& stop, std::size_t first, std::size_t rows, Vec2 at) {
  if (stage.detail != Detail::full || !stage.picture.reactions) return;
  const Resultant carried = resultant_of_stops(*stage.picture.reactions, first, rows);
  if (carried.force == 0.0) return;
  stage.label(stop.name + ": " + stage.value(carried.force, Quantity::force, carried.radius), at, {0.6, 0.8},
              stage.pin_radius + 8, ink::stop);
}

void draw_curved_slot(Stage& stage, std::size_t first) {
  std::vector<Vec2> line;
  for (const Vec2& point : points_of_track(stage.scene, stage.now, first)) line.push_back(stage.page(point));
  draw_band(stage, line, false);
  const Measure& pin = stage.scene.stops[first + 1].on.terms[0].measure;
  label_force(stage, stage.scene.stops[first], first + 1, 2, stage.page(pin.b));
}

/// All of the circle, or between its ends.
void draw_circular_slot(Stage& stage, std::size_t place) {
  const Stop& stop = stage.scene.stops[place];
  const Vec2 centre = stage.page(stop.on.a);
  const bool has_ends = line_of_centres(stop) >= 0;
  double from = 0.0, to = 2 * M_PI;
  if (has_ends) {
    const Stop& ends = stage.scene.stops[place + 2];
    const double turned = stage.now.poses[static_cast<std::size_t>(ends.on.body_a)].angle;
    from = turned + ends.min;
    to = turned + ends.max;
  }
  constexpr int steps = 120;
  std::vector<Vec2> line;
  for (int k = 0; k < (has_ends ? steps + 1 : steps); ++k) {
    line.push_back(centre + (stage.scale * stop.max) * Stage::page_direction(unit(from + (to - from) * k / steps)));
  }
  draw_band(stage, line, !has_ends);
  stage.canvas.circle(centre, 1.5, {.fill = ink::dark});
  label_force(stage, stop, place, has_ends ? 2 : 1, stage.page(stop.on.b));
}

/// Of this body.
void draw_wheel(Stage& stage, PointRef centre, int body, double radius) {
  const Vec2 at = stage.page(centre);
  stage.canvas.circle(at, radius, {.stroke = ink::dark, .width = 1.3});
  // A spoke shows how far the wheel has turned.
  const Vec2 spoke = Stage::page_direction(unit(stage.now.poses[static_cast<std::size_t>(body)].angle));
  stage.canvas.line(at, at + radius * spoke, {.stroke = ink::free_stop, .width = 1.0});
}

/// The pitch circles, and the strand from rim to rim: dashed where it may be slack and carries nothing.
void draw_chain(Stage& stage, std::size_t first) {
  const Stop& stop = stage.scene.stops[first];
  const std::vector<Measure::Term>& terms = stop.on.terms;
  const PointRef a = terms[0].measure.a, b = terms[0].measure.b;
  draw_wheel(stage, a, terms[1].measure.body_b, stage.scale * std::abs(terms[1].factor));
  draw_wheel(stage, b, b.body, stage.scale * std::abs(terms[2].factor));
  // The strand is on the right of a sprocket round which it passes counter-clockwise.
  const Vec2 right = -quarter_turn(unit(stage.now.poses[static_cast<std::size_t>(a.body)].angle));
  const double radius_b = terms[2].measure.body_b == a.body ? -terms[2].factor : terms[2].factor;
  const Vec2 from = stage.page(world(stage.scene, stage.now, a) - terms[1].factor * right);
  const Vec2 to = stage.page(world(stage.scene, stage.now, b) + radius_b * right);
  const Reaction* const carried = stage.picture.reactions ? reaction_of_stop(*stage.picture.reactions, first) : nullptr;
  const bool is_loose = !stop.holds() && stage.picture.reactions && carried == nullptr;
  stage.canvas.line(from, to, {.stroke = ink::dark, .width = 1.6, .dash = is_loose ? "2 4" : ""});
  stage.setter.avoid(from, to, 2.0);
  label_force(stage, stop, first, 1, 0.5 * (from + to));
}

void draw_rolling_on_circle(Stage& stage, std::size_t first) {
  const Stop& stop = stage.scene.stops[first];
  const double radius = stage.scale * circle_of(stage.scene.stops, first);
  const Vec2 centre = stage.page(stop.on.a);
  stage.canvas.circle(centre, radius, {.stroke = ink::ground, .width = 1.8});
  draw_wheel(stage, stop.on.b, stop.on.b.body, stage.scale * wheel_of(stage.scene.stops, first));
  const Vec2 out = stage.page(stop.on.b) - centre;
  if (norm(out) > 0.0) label_force(stage, stop, first, 2, centre + (radius / norm(out)) * out);
}

/// The line through a contact, hatched on the other side than `across`, as long as all of `reaches` need it.
void draw_line_under(Stage& stage, Vec2 contact, Vec2 across, const std::vector<Vec2>& reaches, double margin) {
  const Vec2 along = quarter_turn(across);
  double low = 0.0, high = 0.0;
  for (const Vec2& point : reaches) {
    low = std::min(low, dot(point - contact, along));
    high = std::max(high, dot(point - contact, along));
  }
  const Vec2 begin = contact + (low - margin) * along, end = contact + (high + margin) * along;
  if (stage.detail == Detail::sketch)
    stage.canvas.line(begin, end, {.stroke = ink::ground, .width = 0.8});
  else
    draw_ground(stage.canvas, begin, end, -across);
  stage.setter.avoid(begin, end, 8.0);
}

/// On the page, the direction in which a component counts.
Vec2 direction_of(const Stage& stage, const Measure& component) {
  return Stage::page_direction(direction<double>(component.axis) *
                               unit(stage.now.poses[static_cast<std::size_t>(component.a.body)].angle));
}

/// The line reaches as far as the other positions of the wheel and its rim.
void draw_rolling(Stage& stage, std::size_t first) {
  const Stop& stop = stage.scene.stops[first];
  const Vec2 across = direction_of(stage, stop.on);
  const double radius = stage.scale * stop.max;
  const Vec2 contact = stage.page(stop.on.b) - radius * across;
  std::vector<Vec2> reaches{stage.page(stop.on.a)};
  for (const Readings& other : stage.others) reaches.push_back(stage.page(world(stage.scene, other, stop.on.b)));
  draw_line_under(stage, contact, across, reaches, 1.2 * radius + 8.0);
  draw_wheel(stage, stop.on.b, stop.on.b.body, radius);
  label_force(stage, stop, first, 2, contact);
}

/// The curve, and the line below it and its other positions, or the circle.
void draw_profile(Stage& stage, std::size_t first) {
  const Stop* const rows = &stage.scene.stops[first];
  const Measure& across = rows->on.terms[0].measure;
  std::vector<Vec2> line, reaches;
  for (const Vec2& point : points_of_curve(stage.scene, stage.now, first)) line.push_back(stage.page(point));
  const Measure::Term& curve = rows->on.terms[1];
  const double u = value_of(stage.scene, curve.measure, stage.now.poses) / curve.span;
  const Vec2 contact = stage.page(point_on_curve(stage.scene, stage.now, first, u, false));
  if (rows->table == "rolling_profile_on_circle") {
    stage.canvas.circle(stage.page(across.a), stage.scale * rows->max, {.stroke = ink::ground, .width = 1.8});
  } else {
    reaches = line;
    for (const Readings& other : stage.others) {
      for (const Vec2& point : points_of_curve(stage.scene, other, first)) reaches.push_back(stage.page(point));
    }
    draw_line_under(stage, contact, direction_of(stage, across), reaches, 8.0);
  }
  stage.canvas.polyline(line, {.stroke = ink::dark, .width = 1.3});
  for (std::size_t k = 1; k < line.size(); ++k) stage.setter.avoid(line[k - 1], line[k], 2.0);
  label_force(stage, *rows, first, 2, contact);
}

/// Both curves.
void draw_curve_contact(Stage& stage, std::size_t first) {
  const Stop* const rows = &stage.scene.stops[first];
  for (const bool is_against : {false, true}) {
    std::vector<Vec2> line;
    for (const Vec2& point : points_of_curve(stage.scene, stage.now, first, is_against)) {
      line.push_back(stage.page(point));
    }
    stage.canvas.polyline(line, {.stroke = ink::dark, .width = 1.3});
    for (std::size_t k = 1; k < line.size(); ++k) stage.setter.avoid(line[k - 1], line[k], 2.0);
  }
  const Measure::Term& curve = rows->on.terms[1];
  const double u = value_of(stage.scene, curve.measure, stage.now.poses) / curve.span;
  label_force(stage, *rows, first, 1, stage.page(point_on_curve(stage.scene, stage.now, first, u, false)));
}

}  // namespace

void draw_tracks(Stage& stage) {
  stage.canvas.open("tracks");
  for (std::size_t s = 0; s < stage.scene.stops.size(); ++s) {
    const Stop& stop = stage.scene.stops[s];
    if (!has_track(stop)) continue;
    stage.canvas.item(stop.family() + " " + stop.name);
    if (stop.table == "curved_slot")
      draw_curved_slot(stage, s);
    else if (stop.table == "circular_slot")
      draw_circular_slot(stage, s);
    else if (stop.table == "rolling")
      draw_rolling(stage, s);
    else if (stop.table == "rolling_on_circle")
      draw_rolling_on_circle(stage, s);
    else if (stop.table == "rolling_profile" || stop.table == "rolling_profile_on_circle")
      draw_profile(stage, s);
    else if (stop.table == "curve_contact")
      draw_curve_contact(stage, s);
    else if (stop.table == "chain")
      draw_chain(stage, s);
    stage.signs.insert(stop.table.starts_with("rolling") ? Sign::rolling
                       : stop.table.starts_with("chain") ? Sign::wheels
                                                         : Sign::track);
  }
  stage.canvas.close();
}

void include_track(const Scene& scene, const Readings& readings, std::size_t first, Box& box) {
  const Stop& stop = scene.stops[first];
  if (stop.table == "curved_slot") {
    for (const Vec2& point : points_of_track(scene, readings, first)) box.include(point);
  } else if (stop.table == "circular_slot") {
    box.include(world(scene, readings, stop.on.a), stop.max);
  } else if (stop.table == "rolling") {
    box.include(world(scene, readings, stop.on.b), stop.max);
  } else if (stop.table == "rolling_on_circle") {
    box.include(world(scene, readings, stop.on.a), circle_of(scene.stops, first));
    box.include(world(scene, readings, stop.on.b), wheel_of(scene.stops, first));
  } else if (stop.table == "rolling_profile" || stop.table == "rolling_profile_on_circle") {
    for (const Vec2& point : points_of_curve(scene, readings, first)) box.include(point);
    if (stop.table == "rolling_profile_on_circle")
      box.include(world(scene, readings, stop.on.terms[0].measure.a), stop.max);
  } else if (stop.table == "curve_contact") {
    for (const bool is_against : {false, true}) {
      for (const Vec2& point : points_of_curve(scene, readings, first, is_against)) box.include(point);
    }
  } else if (stop.table == "chain") {
    const std::vector<Measure::Term>& terms = stop.on.terms;
    box.include(world(scene, readings, terms[0].measure.a), std::abs(terms[1].factor));
    box.include(world(scene, readings, terms[0].measure.b), std::abs(terms[2].factor));
  }
}

bool has_track(const Stop& stop) {
  return stop.table.starts_with("circular_slot") || stop.table.starts_with("curved_slot") ||
         stop.table.starts_with("rolling") || stop.table.starts_with("chain") ||
         stop.table.starts_with("curve_contact");
}

}  // namespace poise::app
