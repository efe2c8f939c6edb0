#include "model/named_measures.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "model/named_number.hpp"
#include "model/nearest_name.hpp"

namespace poise {
namespace {

/// Takes "NAME." from the front of a text.
bool take_name(std::string_view& text, std::string_view name) {
  if (!text.starts_with(name) || text.size() == name.size() || text[name.size()] != '.') return false;
  text.remove_prefix(name.size() + 1);
  return true;
}

NamedMeasure angle_of(const Scene& scene, int body, int other) {
  const std::string& name = scene.bodies[static_cast<std::size_t>(body)].name;
  const std::string& against = scene.bodies[static_cast<std::size_t>(other)].name;
  return {.name = fmt::format("angle.{}.{}", name, against),
          .on = Measure::angle_between(other, body),
          .words = fmt::format("angle of {} relative to {}", name, against)};
}

/// The angle of one body from another, where the text behind "angle." begins with the names of both.
std::optional<NamedMeasure> relative_angle(const Scene& scene, std::string_view text) {
  std::optional<NamedMeasure> found;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    std::string_view rest = text;
    if (!take_name(rest, scene.bodies[i].name)) continue;
    for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
      if (k == i || !rest.starts_with(scene.bodies[k].name)) continue;
      NamedMeasure one = angle_of(scene, static_cast<int>(i), static_cast<int>(k));
      if (!found || one.name.size() > found->name.size()) found = std::move(one);
    }
  }
  return found;
}

/// The sine and cosine of an angle in degrees, exact at the axes.
Vec2 direction_of(double degrees) {
  const double quarters = degrees / 90.0;
  if (quarters == std::floor(quarters)) {
    const Vec2 axes[] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    return axes[static_cast<int>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0))];
  }
  const double angle = degrees * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle)};
}

/// The component of a place, where the text behind "along." begins with a point and an angle.
std::optional<NamedMeasure> component_of(const Scene& scene, std::string_view text, std::string_view separators) {
  std::optional<NamedMeasure> found;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      const PointRef point{static_cast<int>(i), static_cast<int>(p)};
      const std::string name = scene.name_of(point);
      std::string_view rest = text;
      if (!take_name(rest, name)) continue;
      // A sign in front is part of the number.
      std::size_t end = rest.starts_with('-') ? 1 : 0;
      while (end < rest.size() && separators.find(rest[end]) == std::string_view::npos) ++end;
      const std::string word(rest.substr(0, end));
      const std::optional<double> degrees = read_number(word);
      if (!degrees || !std::isfinite(*degrees)) continue;
      const Vec2 along = direction_of(*degrees);
      NamedMeasure one{.name = fmt::format("along.{}.{}", name, word),
                       .on = Measure::sum_of({{along.x, Measure::x_of(point)}, {along.y, Measure::y_of(point)}}),
                       .words = fmt::format("place of {} along {} degrees from x", name, word)};
      if (!found || one.name.size() > found->name.size()) found = std::move(one);
    }
  }
  return found;
}

}  // namespace

std::vector<ElementName> names_of_elements(const Scene& scene) {
  std::map<std::string_view, int> count;
  for (const Element& of : scene.elements) ++count[of.name];
  std::vector<ElementName> out;
  for (const Element& of : scene.elements) {
    out.push_back({count[of.name] == 1 ? of.name : "", of.table + "." + of.name});
  }
  return out;
}

std::vector<NamedMeasure> named_measures(const Scene& scene) {
  std::vector<NamedMeasure> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const std::string& name = scene.bodies[i].name;
    out.push_back({.name = "angle." + name,
                   .on = Measure::angle_between(0, static_cast<int>(i)),
                   .words = fmt::format("angle of {} in the world", name),
                   .also = {name}});
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    const std::string& name = scene.joints[j].name;
    if (!scene.joints[j].has_travel()) continue;
    out.push_back({.name = "travel." + name,
                   .on = Measure::travel_of(static_cast<int>(j)),
                   .words = "travel of " + name,
                   .also = {name}});
  }
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      const PointRef point{static_cast<int>(i), static_cast<int>(p)};
      const std::string name = scene.name_of(point);
      out.push_back({.name = "x." + name, .on = Measure::x_of(point), .words = "x of " + name, .also = {name + ".x"}});
      out.push_back({.name = "y." + name, .on = Measure::y_of(point), .words = "y of " + name, .also = {name + ".y"}});
    }
  }
  const std::vector<ElementName> elements = names_of_elements(scene);
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    if (scene.elements[e].feedback && !scene.elements[e].feedback->acts) continue;
    const auto& [own, whole] = elements[e];
    const Measure& on = scene.elements[e].on;
    NamedMeasure one{.name = "length." + (own.empty() ? whole : own),
                     .on = on,
                     .words = fmt::format("{} of {}", on.is_angle() ? "angle" : "length", own.empty() ? whole : own),
                     .also = {"length." + whole, whole}};
    if (!own.empty()) one.also.push_back(own);
    out.push_back(std::move(one));
  }
  return out;
}

std::optional<NamedMeasure> composed_measure(const Scene& scene, std::string_view text, std::string_view separators) {
  constexpr std::string_view angle = "angle.", along = "along.";
  if (text.starts_with(angle)) return relative_angle(scene, text.substr(angle.size()));
  if (text.starts_with(along)) return component_of(scene, text.substr(along.size()), separators);
  return std::nullopt;
}

std::optional<NamedMeasure> find_measure(const Scene& scene, std::string_view name) {
  std::vector<NamedMeasure> listed = named_measures(scene);
  for (NamedMeasure& one : listed) {
    if (one.name == name) return std::move(one);
  }
  std::optional<NamedMeasure> composed = composed_measure(scene, name);
  if (composed && composed->name == name) return composed;
  for (NamedMeasure& one : listed) {
    if (std::find(one.also.begin(), one.also.end(), name) != one.also.end()) return std::move(one);
  }
  return std::nullopt;
}

std::string why_no_measure(const Scene& scene, std::string_view name) {
  for (const auto& [prefix, item] : measure_families) {
    if (!name.starts_with(prefix)) continue;
    std::vector<std::string> known;
    for (const NamedMeasure& one : named_measures(scene)) {
      // Points are those of x.BODY.POINT.
      const std::string_view listed_as = prefix == "along." ? "x." : prefix;
      if (one.name.starts_with(listed_as)) known.push_back(one.name.substr(listed_as.size()));
    }
    return fmt::format("expected the name of {}{}", item, did_you_mean_or_list(name.substr(prefix.size()), known));
  }
  return "";
}

}  // namespace poise
