#include "app/commands/path_positions.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "model/one_line.hpp"
#include "model/text_file.hpp"
#include "statics/model/mobility.hpp"
#include "statics/model/scaled_model.hpp"

namespace poise::app {
namespace {

using nlohmann::json;

constexpr std::size_t most_positions = 1000;

/// Equilibria at values of the number that varies.
std::vector<std::pair<double, json>> points_of(const json& path) {
  std::vector<std::pair<double, json>> out;
  for (const json& at : path.value("at", json::array())) {
    for (const json& point : at.at("equilibria")) out.emplace_back(at.at("parameter").get<double>(), point);
  }
  if (!out.empty()) return out;
  for (const json& point : path.at("points")) out.emplace_back(point.at("parameter").get<double>(), point);
  return out;
}

/// Gives the items of these names their values; false where the scene has one of them not.
template <class Items, class Value, class Read>
bool give(const json& values, const Items& items, std::vector<std::optional<Value>>& to, Read read) {
  for (const auto& one : values.items()) {
    const auto found =
        std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == one.key(); });
    if (found == items.end()) return false;
    to[static_cast<std::size_t>(found - items.begin())] = read(one.value());
  }
  return true;
}

/// The poses in which the scene has the angles, travels and places of the point; none where it has none.
std::optional<std::vector<BodyPose<double>>> poses_at(Scene& scene, const json& point) {
  const Units& units = scene.units;
  const auto angle = [&](const json& value) { return value.get<double>() * units.angle; };
  const auto length = [&](const json& value) { return value.get<double>() * units.length; };
  const auto place = [&](const json& value) { return Vec2{length(value.at(0)), length(value.at(1))}; };
  const json none = json::object();
  if (!give(point.value("angles", none), scene.bodies, scene.start.angle, angle) ||
      !give(point.value("slides", none), scene.joints, scene.start.travel, length) ||
      !give(point.value("positions", none), scene.bodies, scene.start.position, place)) {
    return std::nullopt;
  }
  const ScaledModel model(with_masses(scene), Purpose::dynamics);
  std::vector<BodyPose<double>> out = model.poses(close_loops(model));
  constexpr double near = 1e-5;  // rad: results have more digits
  for (std::size_t b = 1; b < out.size(); ++b) {
    const std::optional<double>& wanted = scene.start.angle[b];
    if (wanted && std::abs(std::remainder(out[b].angle - *wanted, 2 * M_PI)) > near) return std::nullopt;
  }
  return out;
}

std::vector<NamedPosition> read_positions(const std::string& file, const json& path, const Scene& scene) {
  const std::vector<std::pair<double, json>> points = points_of(path);
  if (points.empty() || points.size() > most_positions) {
    throw InputError(fmt::format("{}: expected 1 to {} positions, found {}; say which by --at of poise path", file,
                                 most_positions, points.size()));
  }
  const json& parameter = path.at("parameter");
  const std::string name = parameter.at("name");
  // A driven measure is none of the scene's numbers, and loads are at no place of a drawing.
  const bool is_number = parameter.value("driven", json()).is_null() && name != "loads";
  std::vector<NamedPosition> out;
  for (const auto& [value, point] : points) {
    NamedPosition one{fmt::format("POSE_{}", out.size() + 1), scene, {}};
    try {
      if (is_number) set_value(one.scene, name, value);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}: {}", file, one_line(name), error.what()));
    }
    auto poses = poses_at(one.scene, point);
    if (!poses) {
      throw InputError(
          fmt::format("{}: expected a result of poise path on {} with the same settings, found position {} "
                      "which the scene cannot have",
                      file, one_line(scene.file), out.size() + 1));
    }
    one.poses = *std::move(poses);
    out.push_back(std::move(one));
  }
  return out;
}

}  // namespace

std::vector<NamedPosition> positions_of_path(const std::string& file, const Scene& scene) {
  const json path = json::parse(read_text_file(file), nullptr, false);
  try {
    if (path.is_object() && path.contains("points") && path.contains("parameter"))
      return read_positions(file, path, scene);
  } catch (const json::exception&) {
    throw InputError(file +
                     ": expected the result of poise path with --json FILE of this version, found one that "
                     "lacks keys; follow the path again");
  }
  throw InputError(file + ": expected the result of poise path with --json FILE, found another text");
}

}  // namespace poise::app
