#include "app/view/link_mass.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include "app/draw/symbols.hpp"
#include "app/view/rounded.hpp"
#include "model/dependent_number.hpp"
#include "model/one_line.hpp"
#include "model/toml_text.hpp"

namespace poise::app {
namespace {

// What the tools write has this relative precision at least.
constexpr double same_digits = 2e-6;

/// An area has a size, a first moment and a second moment about the origin; lengths are in m.
struct Area {
  double size = 0.0;
  Vec2 moment{};
  double second = 0.0;

  Vec2 center() const { return (1.0 / size) * moment; }
  /// About its centre, m^4.
  double polar() const { return second - dot(moment, moment) / size; }
};

/// The polygon of a link's points in their order; counterclockwise ones have a positive area.
Area polygon(const std::vector<NamedPoint>& points) {
  Area out;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Vec2 a = points[p].at, b = points[(p + 1) % points.size()].at;
    const double twice = cross(a, b);
    out.size += 0.5 * twice;
    out.moment += (twice / 6.0) * (a + b);
    out.second += twice / 12.0 * (dot(a, a) + dot(a, b) + dot(b, b));
  }
  return out;
}

/// The greatest distance of two points, with the middle between them.
std::pair<double, Vec2> longest_line(const std::vector<NamedPoint>& points) {
  std::pair<double, Vec2> out{0.0, {}};
  for (const NamedPoint& a : points) {
    for (const NamedPoint& b : points) {
      if (norm(b.at - a.at) > out.first) out = {norm(b.at - a.at), 0.5 * (a.at + b.at)};
    }
  }
  return out;
}

bool has_area(const Area& area, const Body& link) {
  const double size = longest_line(link.points).first;
  return std::abs(area.size) > 1e-9 * size * size;
}

struct Hole {
  std::string point, written;
  Vec2 at{};              // m
  double diameter = 0.0;  // m
};

double positive(const char* key, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !(value > 0.0) || !std::isfinite(value))
    throw InputError(fmt::format("{}: expected a number above 0, found \"{}\"", key, one_line(text)));
  return value;
}

/// Reads holes from a TOML string, "A 8, B 6".
std::vector<Hole> holes_of(const Body& link, const std::string& text, double unit) {
  std::vector<Hole> out;
  std::istringstream list(text.substr(1, text.size() - 2));
  for (std::string one; std::getline(list, one, ',');) {
    std::istringstream words(one);
    Hole hole;
    std::string more;
    if (!(words >> hole.point)) continue;
    words >> hole.written;
    const auto at = std::find_if(link.points.begin(), link.points.end(),
                                 [&](const NamedPoint& point) { return point.name == hole.point; });
    if (at == link.points.end() || hole.written.empty() || words >> more) {
      throw InputError(fmt::format("holes: expected points of {} with diameters, \"{} 8\", found \"{}\"", link.name,
                                   link.points.front().name, one_line(one)));
    }
    hole.at = at->at;
    hole.diameter = positive("holes", hole.written) * unit;
    out.push_back(std::move(hole));
  }
  return out;
}

/// The points of a plate's edge in their order: a hole inside is no corner of it.
std::vector<NamedPoint> outline_around(const std::vector<NamedPoint>& points, const std::vector<Hole>& holes) {
  std::vector<Vec2> all;
  for (const NamedPoint& point : points) all.push_back(point.at);
  const std::vector<Vec2> hull = convex_hull(std::move(all));
  std::vector<NamedPoint> out;
  for (const NamedPoint& point : points) {
    const bool has_hole =
        std::any_of(holes.begin(), holes.end(), [&](const Hole& hole) { return hole.point == point.name; });
    if (!has_hole || std::find(hull.begin(), hull.end(), point.at) != hull.end()) out.push_back(point);
  }
  return out;
}

struct Plate {
  double outline = 0.0;  // its area, m^2
  Area area{};           // without the holes
};

/// Nothing where the points enclose no area.
std::optional<Plate> plate_with(const Body& link, const std::vector<Hole>& holes) {
  Area area = polygon(outline_around(link.points, holes));
  if (area.size < 0.0) area = {-area.size, -1.0 * area.moment, -area.second};
  if (!has_area(area, link)) return std::nullopt;
  Plate out{area.size, area};
  for (const Hole& hole : holes) {
    const double part = std::numbers::pi / 4.0 * hole.diameter * hole.diameter;
    out.area.size -= part;
    out.area.moment += -part * hole.at;
    out.area.second -= part * (dot(hole.at, hole.at) + hole.diameter * hole.diameter / 8.0);
  }
  return out;
}

std::string pair_of(Vec2 si, double unit, double grain) {
  return fmt::format("[{}, {}]", rounded(si.x / unit, grain / unit), rounded(si.y / unit, grain / unit));
}

TomlKeys keys_of_plate(const Body& link, const std::string& of_area, const std::vector<Hole>& holes, double unit,
                       double grain) {
  const std::optional<Plate> plate = plate_with(link, holes);
  if (!plate) throw InputError("expected a link whose points enclose an area; the tool Mass is for bars");
  const Area& area = plate->area;
  if (!(area.size > 0.0) || !(area.polar() > 0.0)) throw InputError("holes: expected smaller ones than the link");
  std::string in_words = fmt::format("{:.7g}", plate->outline / (unit * unit)), squares;
  for (const Hole& hole : holes) squares += (squares.empty() ? "" : " + ") + hole.written + "^2";
  if (!squares.empty()) in_words = fmt::format("({} - pi/4*({}))", in_words, squares);
  return {{"mass", toml_string(of_area + "*" + in_words)},
          {"center", pair_of(area.center(), unit, grain)},
          {"inertia", toml_string(fmt::format("{}*{:.7g}", of_area, area.polar() / std::pow(unit, 4)))}};
}

/// A value as it reads within an expression.
std::string as_factor(const std::string& value) {
  const bool is_text = value.size() > 1 && value.front() == '"';
  return is_text ? "(" + value.substr(1, value.size() - 2) + ")" : value;
}

/// The centre and the radius of gyration, m, of a bar or of the polygon of the points.
std::pair<Vec2, double> spread_over(const Body& link) {
  const Area area = polygon(link.points);
  if (has_area(area, link)) return {area.center(), std::sqrt(std::max(0.0, area.polar() / area.size))};
  const auto [longest, middle] = longest_line(link.points);
  return {middle, longest / std::sqrt(12.0)};
}

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return !text.empty() && *end == '\0' ? std::optional(value) : std::nullopt;
}

bool is_near(double a, double b, double relative) { return std::abs(a - b) <= relative * std::abs(b); }

/// The words that a tool wrote for a link, where it did.
class WrittenMass {
 public:
  WrittenMass(const Scene& scene, int body)
      : link_(scene.bodies[static_cast<std::size_t>(body)]), unit_(scene.units.length) {
    const DependentNumber* const mass = dependent_number(scene, {Owner::body, body, 0, number_called("mass")});
    const DependentNumber* const inertia = dependent_number(scene, {Owner::body, body, 0, number_called("inertia")});
    if (inertia == nullptr) return;
    const std::string& text = inertia->expression.text();
    const std::size_t star = text.rfind('*');
    if (star == std::string::npos) return;
    const std::string factor = text.substr(0, star), rest = text.substr(star + 1);
    const std::string of_mass = mass != nullptr ? mass->expression.text() : "";
    if (rest.ends_with("^2")) {
      const std::optional<double> arm = number_in(rest.substr(0, rest.size() - 2));
      const std::string mass_text = mass != nullptr ? toml_string(of_mass) : toml_number(link_.mass / scene.units.mass);
      const bool is_same_mass =
          mass != nullptr ? factor == as_factor(mass_text)
                          : number_in(factor) && is_near(*number_in(factor), link_.mass / scene.units.mass, 1e-12);
      if (arm && is_same_mass) read_spread(*arm, mass != nullptr ? mass_text : factor);
    } else if (of_mass.starts_with(factor + "*")) {
      if (const std::optional<double> polar = number_in(rest))
        read_plate(factor, of_mass.substr(factor.size() + 1), *polar);
    }
  }

  /// What the tool writes of the link with other points; nothing where none wrote it.
  TomlKeys of(const Body& link, double grain, const Units& units) const {
    if (!mass_.empty()) return spread_mass(link, mass_, units, grain);
    if (of_area_.empty()) return {};
    std::vector<Hole> holes = holes_;
    for (Hole& hole : holes) {
      hole.at = std::find_if(link.points.begin(), link.points.end(), [&](const NamedPoint& point) {
                  return point.name == hole.point;
                })->at;
    }
    return keys_of_plate(link, of_area_, holes, unit_, grain);
  }

 private:
  static int number_called(std::string_view name) {
    const auto at =
        std::find_if(Body::numbers.begin(), Body::numbers.end(), [&](const Number& one) { return one.key == name; });
    return static_cast<int>(at - Body::numbers.begin());
  }

  /// Rounding is to a power of ten that was as fine as the picture.
  bool is_center(Vec2 center) const { return norm(center - link_.center) <= 1e-2 * longest_line(link_.points).first; }

  void read_spread(double arm, const std::string& mass) {
    const auto [center, radius] = spread_over(link_);
    if (is_center(center) && std::abs(arm * unit_ - radius) <= 1e-2 * radius) mass_ = mass;
  }

  /// "A", or "(A - pi/4*(d^2 + ...))": the holes are round those points for which centre and inertia come out.
  void read_plate(const std::string& of_area, std::string area, double polar) {
    std::vector<Hole> holes;
    constexpr std::string_view between = " - pi/4*(";
    if (area.starts_with("(") && area.ends_with("))")) {
      const std::size_t at = area.find(between);
      if (at == std::string::npos) return;
      std::string squares = area.substr(at + between.size(), area.size() - 2 - at - between.size());
      area = area.substr(1, at - 1);
      for (std::size_t end = 0; end != std::string::npos; squares.erase(0, end == std::string::npos ? 0 : end + 3)) {
        end = squares.find(" + ");
        const std::string square = squares.substr(0, end);
        const std::optional<double> diameter =
            square.ends_with("^2") ? number_in(square.substr(0, square.size() - 2)) : std::nullopt;
        if (!diameter) return;
        holes.push_back({"", square.substr(0, square.size() - 2), {}, *diameter * unit_});
      }
    }
    const std::optional<double> size = number_in(area);
    constexpr double most_ways = 1e5;
    if (!size || std::pow(link_.points.size(), holes.size()) > most_ways) return;
    double nearest = std::numeric_limits<double>::infinity();
    place_holes(holes, 0, *size * unit_ * unit_, polar * std::pow(unit_, 4), nearest);
    if (std::isfinite(nearest)) of_area_ = of_area;
  }

  void place_holes(std::vector<Hole>& holes, std::size_t from, double outline, double polar, double& nearest) {
    if (from < holes.size()) {
      for (const NamedPoint& point : link_.points) {
        holes[from].point = point.name;
        holes[from].at = point.at;
        place_holes(holes, from + 1, outline, polar, nearest);
      }
      return;
    }
    const std::optional<Plate> plate = plate_with(link_, holes);
    if (!plate || !is_near(outline, plate->outline, same_digits)) return;
    const double far = norm(plate->area.center() - link_.center);
    if (!is_near(polar, plate->area.polar(), same_digits) || !is_center(plate->area.center()) || far >= nearest) return;
    nearest = far;
    holes_ = holes;
  }

  const Body& link_;
  double unit_;
  std::string of_area_, mass_;
  std::vector<Hole> holes_;
};

}  // namespace

TomlKeys spread_mass(const Body& link, const std::string& mass, const Units& units, double grain) {
  const auto [center, radius] = spread_over(link);
  const std::string arm = rounded(radius / units.length, grain / units.length);
  return {{"mass", mass},
          {"center", pair_of(center, units.length, grain)},
          {"inertia", toml_string(fmt::format("{}*{}^2", as_factor(mass), arm))}};
}

TomlKeys mass_of_plate(const Body& link, const PlateWords& words, const Units& units, double grain) {
  if (words.thickness.front() != '"') positive("thickness", words.thickness);
  // A mass per area and thickness, in the units of the scene.
  const double per_volume = positive("density", words.density) * std::pow(units.length, 3) / units.mass;
  return keys_of_plate(link, fmt::format("{:.6g}*{}", per_volume, as_factor(words.thickness)),
                       holes_of(link, words.holes, units.length), units.length, grain);
}

std::vector<std::pair<std::string, TomlKeys>> masses_that_follow(const Scene& before, const Scene& after,
                                                                 double grain) {
  std::vector<std::pair<std::string, TomlKeys>> out;
  for (std::size_t b = 1; b < std::min(before.bodies.size(), after.bodies.size()); ++b) {
    const std::vector<NamedPoint>&old = before.bodies[b].points, &points = after.bodies[b].points;
    const auto is_there = [](const NamedPoint& a, const NamedPoint& other) { return a.at == other.at; };
    if (std::equal(old.begin(), old.end(), points.begin(), points.end(), is_there)) continue;
    TomlKeys keys = WrittenMass(before, static_cast<int>(b)).of(after.bodies[b], grain, after.units);
    if (!keys.empty()) out.emplace_back(after.bodies[b].name, std::move(keys));
  }
  return out;
}

}  // namespace poise::app
