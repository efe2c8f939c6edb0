#include "app/draw/symbols.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace poise::app {
namespace {

constexpr double hatch_pitch = 6.0;
constexpr double hatch_depth = 6.0;

Vec2 direction(Vec2 a, Vec2 b) {
  const double length = norm(b - a);
  return length > 0 ? (1 / length) * (b - a) : Vec2{1, 0};
}

// Length of the ends that what is moved aside keeps on the line from a to b.
double corner_of(Vec2 a, Vec2 b, Vec2 shift) { return norm(shift) > 0 ? std::min(14.0, 0.12 * norm(b - a)) : 0.0; }

// Tip and the two corners of an arrow's head that points along `u`.
void draw_head(Canvas& canvas, Vec2 tip, Vec2 u, double length, Colour colour) {
  const Vec2 back = tip - length * u;
  const Vec2 side = 0.36 * length * quarter_turn(u);
  canvas.polygon({tip, back + side, back - side}, {.fill = colour, .stroke = colour, .width = 0.6});
}

}  // namespace

double seen_angle(Vec2 direction) { return std::atan2(-direction.y, direction.x); }

void draw_ground(Canvas& canvas, Vec2 a, Vec2 b, Vec2 down) {
  const Paint thin{.stroke = ink::ground, .width = 0.9};
  const Vec2 along = direction(a, b);
  const double length = norm(b - a);
  const int strokes = std::max(2, static_cast<int>(std::floor(length / hatch_pitch)));
  for (int i = 0; i < strokes; ++i) {
    const Vec2 on_line = a + ((i + 0.8) * length / strokes) * along;
    canvas.line(on_line, on_line - hatch_depth * along + hatch_depth * down, thin);
  }
  canvas.line(a, b, {.stroke = ink::dark, .width = 1.6});
}

void draw_support(Canvas& canvas, Vec2 at, Vec2 down) {
  const Vec2 along = quarter_turn(down);
  const Vec2 foot = at + 17.0 * down;
  canvas.polygon({at, foot + 10.0 * along, foot - 10.0 * along},
                 {.fill = ink::support, .stroke = ink::dark, .width = 1.4});
  draw_ground(canvas, foot - 17.0 * along, foot + 17.0 * along, down);
}

void draw_pin(Canvas& canvas, Vec2 at, double radius) {
  canvas.circle(at, radius, {.fill = ink::paper, .stroke = ink::dark, .width = std::max(0.8, 0.36 * radius)});
}

void draw_centre_of_mass(Canvas& canvas, Vec2 at, double radius) {
  canvas.circle(at, radius, {.fill = ink::paper, .stroke = ink::dark, .width = 0.9});
  for (int quarter : {0, 2}) {
    const Vec2 u = unit(quarter * M_PI_2);
    std::vector<Vec2> wedge{at};
    for (int i = 0; i <= 6; ++i) wedge.push_back(at + radius * (u * unit(i * M_PI_2 / 6)));
    canvas.polygon(wedge, {.fill = ink::dark});
  }
}

void draw_bar(Canvas& canvas, Vec2 a, Vec2 b, double width, Colour fill) {
  const double rim = std::min(1.1, 0.2 * width);
  canvas.line(a, b, {.stroke = ink::dark, .width = width});
  canvas.line(a, b, {.stroke = fill, .width = width - 2 * rim});
}

void draw_cylinder(Canvas& canvas, Vec2 foot, Vec2 mouth, Vec2 piston, Vec2 eye, double width, Colour barrel,
                   Colour rod) {
  const Vec2 along = direction(foot, eye);
  const Vec2 half = 0.5 * width * quarter_turn(along);
  const Vec2 base = foot + std::min(0.7 * width, 0.3 * norm(mouth - foot)) * along;
  const std::vector<Vec2> tube{base + half, mouth + half, mouth - half, base - half};
  draw_bar(canvas, foot, base, 0.45 * width, barrel);
  canvas.polygon(tube, {.fill = ink::paper});
  canvas.polygon(tube, {.fill = barrel, .opacity = 0.4});
  draw_bar(canvas, piston, eye, 0.35 * width, rod);
  canvas.line(piston + 0.8 * half, piston - 0.8 * half, {.stroke = ink::dark, .width = 0.25 * width});
  canvas.polygon(tube, {.stroke = ink::dark, .width = 1.2});
}

void draw_massless_bar(Canvas& canvas, Vec2 a, Vec2 b, double width) { draw_bar(canvas, a, b, width, ink::paper); }

void draw_block(Canvas& canvas, Vec2 at, Vec2 axis, double length, double height, const Paint& paint) {
  const Vec2 l = 0.5 * length * axis;
  const Vec2 h = 0.5 * height * quarter_turn(axis);
  canvas.polygon({at - l - h, at + l - h, at + l + h, at - l + h}, paint);
}

void draw_slot(Canvas& canvas, Vec2 a, Vec2 b, double width, const Paint& paint) {
  canvas.line(a, b, {.stroke = paint.stroke, .width = width});
  canvas.line(a, b, {.stroke = paint.fill, .width = width - 2 * paint.width});
}

void draw_spring(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint) {
  constexpr double pitch = 9.0;
  constexpr int most_teeth = 28;
  const Vec2 along = direction(a, b);
  const Vec2 side = quarter_turn(along);
  const Vec2 corner = corner_of(a, b, shift) * along;
  const Vec2 begin = a + corner + shift;
  const double length = norm(b - corner + shift - begin);
  const double coiled = std::min(length - 2 * std::min(28.0, 0.15 * length), most_teeth * pitch);
  const double straight = 0.5 * (length - coiled);
  const int teeth = std::clamp(static_cast<int>(std::lround(coiled / pitch)), 4, most_teeth);
  const double reach = std::min(7.0, 2.0 + 0.12 * length);
  std::vector<Vec2> points{a};
  if (norm(shift) > 0) points.insert(points.end(), {a + corner, begin});
  points.push_back(begin + straight * along);
  for (int i = 0; i < teeth; ++i) {
    points.push_back(begin + (straight + (i + 0.5) * coiled / teeth) * along + (i % 2 == 0 ? reach : -reach) * side);
  }
  points.push_back(begin + (straight + coiled) * along);
  if (norm(shift) > 0) points.insert(points.end(), {b - corner + shift, b - corner});
  points.push_back(b);
  canvas.polyline(points, paint);
}

void draw_dashpot(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint) {
  const double length = norm(b - a);
  const Vec2 along = direction(a, b);
  const double half_length = std::min(13.0, 0.2 * length);
  const Vec2 half_width = std::min(6.5, 2.0 + 0.1 * length) * quarter_turn(along);
  const double corner = corner_of(a, b, shift);
  const Vec2 from = a + corner * along;
  const Vec2 to = b - corner * along;
  const Vec2 middle = 0.5 * (a + b) + shift;
  const Vec2 base = middle - half_length * along;
  const Vec2 mouth = middle + half_length * along;
  canvas.polyline({mouth + half_width, base + half_width, base - half_width, mouth - half_width}, paint);
  canvas.line(middle + 0.7 * half_width, middle - 0.7 * half_width, paint);
  canvas.polyline({a, from, from + shift, base}, paint);
  canvas.polyline({middle, to + shift, to, b}, paint);
}

void draw_gas_strut(Canvas& canvas, Vec2 a, Vec2 b, Vec2 shift, const Paint& paint) {
  const double length = norm(b - a);
  const Vec2 along = direction(a, b);
  const Vec2 half_width = std::min(5.0, 2.0 + 0.06 * length) * quarter_turn(along);
  const double corner = corner_of(a, b, shift);
  const Vec2 from = a + corner * along;
  const Vec2 to = b - corner * along;
  const Vec2 base = a + shift + 0.12 * length * along;
  const Vec2 mouth = a + shift + 0.6 * length * along;
  const Vec2 piston = a + shift + 0.42 * length * along;
  canvas.polyline({mouth + half_width, base + half_width, base - half_width, mouth - half_width, mouth + half_width},
                  paint);
  canvas.line(piston + half_width, piston - half_width, paint);
  canvas.polyline({a, from, from + shift, base}, paint);
  canvas.polyline({piston, to + shift, to, b}, paint);
}

void draw_spiral(Canvas& canvas, Vec2 at, Vec2 end, double radius, const Paint& paint) {
  constexpr double turns = 2.25;
  constexpr int steps = 72;
  const double inner = std::max(0.32 * radius, radius - 10.2);
  std::vector<Vec2> points;
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    points.push_back(at + (inner + (radius - inner) * part) * (end * unit((part - 1) * turns * 2 * M_PI)));
  }
  canvas.polyline(points, paint);
}

void draw_blade(Canvas& canvas, Vec2 at, Vec2 along, double half_length, Colour colour) {
  constexpr double thin = 3.0, shoulder = 0.55;  // px, part of the length
  const Vec2 end = half_length * along, side = thin * quarter_turn(along);
  canvas.polygon({at - end, at - shoulder * end + side, at + shoulder * end + side, at + end,
                  at + shoulder * end - side, at - shoulder * end - side},
                 {.fill = colour, .stroke = colour, .width = 1.0});
}

void draw_motor(Canvas& canvas, Vec2 at, double radius, const Paint& paint) {
  canvas.circle(at, radius, paint);
  std::vector<Vec2> letter;
  for (const Vec2 p : {Vec2{-1, 1}, Vec2{-1, -1}, Vec2{0, 0.3}, Vec2{1, -1}, Vec2{1, 1}})
    letter.push_back(at + 0.45 * radius * p);
  canvas.polyline(letter, paint);
}

namespace {

// The disc of this radius ends beside the mouths of the slots.
double geneva_disc_radius(int slots) { return std::sin(M_PI / slots) - 2.2 * geneva_pin_radius(slots); }

/// Adds points of an arc from one angle to another.
void add_arc(std::vector<Vec2>& points, Vec2 centre, double radius, double from, double to) {
  const int parts = 1 + static_cast<int>(std::abs(to - from) * 16);
  for (int k = 0; k <= parts; ++k) points.push_back(centre + radius * unit(from + (to - from) * k / parts));
}

}  // namespace

double geneva_pin_radius(int slots) {
  const double crank = std::sin(M_PI / slots);
  return std::min(0.15 * crank, 0.4 * (1.0 - crank));
}

std::vector<Vec2> geneva_wheel(int slots) {
  const double half = M_PI / slots, crank = std::sin(half), rim = std::cos(half);
  const double pin = geneva_pin_radius(slots), disc = geneva_disc_radius(slots);
  const double beside_slot = std::asin(pin / rim);
  // Half of the hollow in which the disc turns, as seen from the wheel's axis and from that of the disc.
  const double hollow = std::acos((1.0 + rim * rim - disc * disc) / (2.0 * rim));
  const double of_disc = std::asin(rim * std::sin(hollow) / disc);
  std::vector<Vec2> out;
  for (int k = 0; k < slots; ++k) {
    const double slot = 2.0 * half * k, between = slot + half;
    add_arc(out, (1.0 - crank) * unit(slot), pin, slot + 1.5 * M_PI, slot + 0.5 * M_PI);
    add_arc(out, {}, rim, slot + beside_slot, between - hollow);
    add_arc(out, unit(between), disc, between + M_PI + of_disc, between + M_PI - of_disc);
    add_arc(out, {}, rim, between + hollow, slot + 2.0 * half - beside_slot);
  }
  return out;
}

std::vector<Vec2> geneva_disc(int slots) {
  const double crank = std::sin(M_PI / slots), disc = geneva_disc_radius(slots), in_slot = std::acos(crank);
  // Cut out around the wheel's axis from where the disc begins to hold.
  const double cut = std::sqrt(1.0 + disc * disc - 2.0 * disc * crank);
  const double of_cut = std::asin(disc * std::sin(in_slot) / cut);
  std::vector<Vec2> out;
  add_arc(out, {}, disc, in_slot, 2.0 * M_PI - in_slot);
  add_arc(out, {1, 0}, cut, M_PI + of_cut, M_PI - of_cut);
  return out;
}

void draw_controller(Canvas& canvas, Vec2 at, double radius, const Paint& paint) {
  const auto around = [&](const std::vector<Vec2>& places, double size) {
    std::vector<Vec2> out;
    for (const Vec2 p : places) out.push_back(at + size * radius * p);
    return out;
  };
  canvas.polygon(around({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0.85), paint);
  canvas.polyline(
      around({{0.8, -0.7}, {0.3, -1}, {-0.4, -0.9}, {-0.8, -0.4}, {-0.8, 0.4}, {-0.4, 0.9}, {0.3, 1}, {0.8, 0.7}}, 0.5),
      paint);
}

void draw_arrow(Canvas& canvas, Vec2 tail, Vec2 tip, Colour colour, double width, std::string_view dash) {
  const Vec2 u = direction(tail, tip);
  const double head = std::min(5.0 + 2.6 * width, 0.8 * norm(tip - tail));
  canvas.line(tail, tip - 0.8 * head * u, {.stroke = colour, .width = width, .dash = dash});
  draw_head(canvas, tip, u, head, colour);
}

void draw_turning_arrow(Canvas& canvas, Vec2 at, double radius, Vec2 from, bool counter_clockwise, Colour colour,
                        double width, std::string_view dash) {
  constexpr double sweep = 4.2;
  const double sense = counter_clockwise ? 1.0 : -1.0;
  const double begin = seen_angle(from);
  const double end = begin + sense * sweep;
  const double head = 5.0 + 2.6 * width;
  canvas.arc(at, radius, begin, end - sense * 0.8 * head / radius, {.stroke = colour, .width = width, .dash = dash});
  // A chord of the head's length, so that the head lies on the circle.
  const Vec2 tip = at + radius * conj(unit(end));
  const Vec2 back = at + radius * conj(unit(end - sense * head / radius));
  draw_head(canvas, tip, direction(back, tip), head, colour);
}

void draw_burst(Canvas& canvas, Vec2 at, double from, double to, const Paint& paint) {
  constexpr int rays = 8;
  for (int k = 0; k < rays; ++k) {
    const Vec2 u = unit((k + 0.5) * 2 * M_PI / rays);
    canvas.line(at + from * u, at + to * u, paint);
  }
}

double distance_to_line(Vec2 point, Vec2 a, Vec2 b) {
  const Vec2 d = b - a;
  const double length2 = dot(d, d);
  const double part = length2 > 0 ? std::clamp(dot(d, point - a) / length2, 0.0, 1.0) : 0.0;
  return norm(point - (a + part * d));
}

std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
  const auto before = [](Vec2 a, Vec2 b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  std::sort(points.begin(), points.end(), before);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  double span = norm(points.back() - points.front());
  for (const Vec2& p : points) span = std::max(span, norm(p - points.front()));
  const double straight = 1e-9 * span * span;
  // Lower, then upper chain.
  std::vector<Vec2> hull;
  const auto chain = [&](auto first, auto last, std::size_t base) {
    for (auto p = first; p != last; ++p) {
      while (hull.size() >= base + 2 && cross(hull.back() - hull[hull.size() - 2], *p - hull.back()) <= straight) {
        hull.pop_back();
      }
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  chain(points.begin(), points.end(), 0);
  chain(points.rbegin(), points.rend(), hull.size());
  return hull;
}

}  // namespace poise::app
