#include "model/section_profiles.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string_view>

#include "model/nearest_name.hpp"

namespace poise {
namespace {

using std::numbers::pi;

/// A rolled I: height, width, thickness of web and flanges, radius of the fillets; mm.
struct Rolled {
  std::string_view name;
  double h, b, web, flange, fillet;
};

// EN 10365:2017 (the same as in Euronorm 19-57 and 53-62).
constexpr Rolled rolled[] = {
    {"IPE 80", 80, 46, 3.8, 5.2, 5},       {"IPE 100", 100, 55, 4.1, 5.7, 7},     {"IPE 120", 120, 64, 4.4, 6.3, 7},
    {"IPE 140", 140, 73, 4.7, 6.9, 7},     {"IPE 160", 160, 82, 5.0, 7.4, 9},     {"IPE 180", 180, 91, 5.3, 8.0, 9},
    {"IPE 200", 200, 100, 5.6, 8.5, 12},   {"IPE 220", 220, 110, 5.9, 9.2, 12},   {"IPE 240", 240, 120, 6.2, 9.8, 15},
    {"IPE 270", 270, 135, 6.6, 10.2, 15},  {"IPE 300", 300, 150, 7.1, 10.7, 15},  {"IPE 330", 330, 160, 7.5, 11.5, 18},
    {"IPE 360", 360, 170, 8.0, 12.7, 18},  {"IPE 400", 400, 180, 8.6, 13.5, 21},  {"IPE 450", 450, 190, 9.4, 14.6, 21},
    {"IPE 500", 500, 200, 10.2, 16.0, 21}, {"IPE 550", 550, 210, 11.1, 17.2, 24}, {"IPE 600", 600, 220, 12.0, 19.0, 24},
    {"HEA 100", 96, 100, 5.0, 8.0, 12},    {"HEA 120", 114, 120, 5.0, 8.0, 12},   {"HEA 140", 133, 140, 5.5, 8.5, 12},
    {"HEA 160", 152, 160, 6.0, 9.0, 15},   {"HEA 180", 171, 180, 6.0, 9.5, 15},   {"HEA 200", 190, 200, 6.5, 10.0, 18},
    {"HEB 100", 100, 100, 6.0, 10.0, 12},  {"HEB 120", 120, 120, 6.5, 11.0, 12},  {"HEB 140", 140, 140, 7.0, 12.0, 12},
    {"HEB 160", 160, 160, 8.0, 13.0, 15},  {"HEB 180", 180, 180, 8.5, 14.0, 15},  {"HEB 200", 200, 200, 9.0, 15.0, 18}};

SectionProfile rectangle(double b, double h) { return {b * h, b * h * h * h / 12, h}; }

SectionProfile circle(double d) { return {pi * d * d / 4, pi * d * d * d * d / 64, d}; }

SectionProfile without(const SectionProfile& whole, const SectionProfile& hole) {
  return {whole.area - hole.area, whole.second_moment - hole.second_moment, whole.height};
}

/// Four fillets, each a square of side r without a quarter of a circle whose centre is the corner that lies away from
/// web and flange; `corner` is the distance of the other two sides' common corner from the axis. Moments of the square
/// and of the quarter about their own centroids are taken to the axis.
SectionProfile fillets(double r, double corner) {
  const double square = r * r, quarter = pi * square / 4;
  const double to_centre = corner - r;  // of the circle
  const double own = pi * square * square / 16 - quarter * std::pow(4 * r / (3 * pi), 2);
  const double at_square = corner - r / 2, at_quarter = to_centre + 4 * r / (3 * pi);
  const double second = square * square / 12 + square * at_square * at_square - own - quarter * at_quarter * at_quarter;
  return {4 * (square - quarter), 4 * second, 0.0};
}

SectionProfile of(const Rolled& i) {
  constexpr double mm = 1e-3;
  const double h = mm * i.h, b = mm * i.b, web = mm * i.web, flange = mm * i.flange, r = mm * i.fillet;
  const double between = h - 2 * flange;
  const SectionProfile plates = without(rectangle(b, h), rectangle(b - web, between));
  const SectionProfile corners = fillets(r, between / 2);
  return {plates.area + corners.area, plates.second_moment + corners.second_moment, h};
}

struct ShapeName {
  std::string_view word;
  std::size_t dimensions;
  std::string_view written;
};

constexpr ShapeName shapes[] = {
    {"rectangle", 2, "rectangle BxH"}, {"round", 1, "round D"}, {"tube", 2, "tube DxT"}, {"box", 3, "box BxHxT"}};

/// "10x20", each number times `unit`; fails unless there are so many, all positive.
std::vector<double> read_dimensions(const TomlText& text, const ShapeName& shape, std::string_view list, double unit) {
  std::vector<double> out;
  const auto fail = [&] {
    text.place.fail("expected \"" + std::string(shape.written) + "\" with positive numbers, found \"" + text.value +
                    "\"");
  };
  const char* at = list.data();
  const char* const end = at + list.size();
  for (;;) {
    double number = 0.0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc() || !contains(Range::positive, number * unit)) fail();
    out.push_back(number * unit);
    if (next == end) break;
    if (*next != 'x') fail();
    at = next + 1;
  }
  if (out.size() != shape.dimensions) fail();
  return out;
}

}  // namespace

std::vector<std::string> rolled_sections() {
  std::vector<std::string> out;
  for (const Rolled& one : rolled) out.emplace_back(one.name);
  return out;
}

SectionProfile read_profile(const TomlText& text, double length_unit) {
  const std::string_view value = text.value;
  for (const Rolled& one : rolled) {
    if (one.name == value) return of(one);
  }
  const std::size_t space = value.find(' ');
  for (const ShapeName& shape : shapes) {
    if (value.substr(0, space) != shape.word) continue;
    const std::string_view list = space == std::string_view::npos ? std::string_view() : value.substr(space + 1);
    const std::vector<double> d = read_dimensions(text, shape, list, length_unit);
    if (shape.word == "rectangle") return rectangle(d[0], d[1]);
    if (shape.word == "round") return circle(d[0]);
    const double wall = d.back(), narrowest = shape.word == "tube" ? d[0] : std::min(d[0], d[1]);
    if (2 * wall >= narrowest)
      text.place.fail("expected a wall T thinner than half the profile, found \"" + text.value + "\"");
    if (shape.word == "tube") return without(circle(d[0]), circle(d[0] - 2 * wall));
    return without(rectangle(d[0], d[1]), rectangle(d[0] - 2 * wall, d[1] - 2 * wall));
  }
  std::vector<std::string> known = rolled_sections();
  for (const ShapeName& shape : shapes) known.emplace_back(shape.written);
  text.place.fail(
      "expected a profile, say \"IPE 80\", \"HEA 100\", \"HEB 100\", \"rectangle BxH\", \"round D\", \"tube "
      "DxT\" or \"box BxHxT\", found \"" +
      text.value + "\"" + did_you_mean(text.value, known));
}

}  // namespace poise
