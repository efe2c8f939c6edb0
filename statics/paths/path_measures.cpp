#include "statics/paths/path_measures.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {
namespace {

SoughtQuantity measured(std::string name, const Measure& on) {
  return {.name = std::move(name), .on = on, .dimension = on.dimension()};
}

/// Coordinates of all points of bodies: "arm.tip.x", "arm.tip.y".
std::vector<SoughtQuantity> coordinates_of(const Scene& scene) {
  std::vector<SoughtQuantity> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    for (std::size_t p = 0; p < scene.bodies[i].points.size(); ++p) {
      const PointRef point{static_cast<int>(i), static_cast<int>(p)};
      out.push_back(measured(scene.name_of(point) + ".x", Measure::x_of(point)));
      out.push_back(measured(scene.name_of(point) + ".y", Measure::y_of(point)));
    }
  }
  return out;
}

/// Angles of bodies, travels of joints and coordinates of points, in the order in which names are looked for.
std::vector<SoughtQuantity> measures_of_pose(const Scene& scene) {
  std::vector<SoughtQuantity> out;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    out.push_back(measured(scene.bodies[i].name, Measure::angle_between(0, static_cast<int>(i))));
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    out.push_back(measured(scene.joints[j].name, Measure::travel_of(static_cast<int>(j))));
  }
  for (SoughtQuantity& coordinate : coordinates_of(scene)) out.push_back(std::move(coordinate));
  return out;
}

/// Angles of bodies that can turn and all travels, or else coordinates.
std::vector<SoughtQuantity> moving_measures(const StaticModel& model) {
  std::vector<SoughtQuantity> out;
  for (SoughtQuantity& measure : measures_of_pose(model.scene())) {
    const bool turns = measure.on.is_angle() && model.layout().links[measure.on.body_b].frame >= 0;
    if (turns || measure.on.kind == Measure::Kind::travel) out.push_back(std::move(measure));
  }
  return out.empty() ? coordinates_of(model.scene()) : out;
}

}  // namespace

const StaticModel& PathReader::model(const PathPoint& point) {
  // Poses do not depend on loads, stiffnesses and driven measures.
  const double at = varied_.is_affine() ? varied_.generic() : point.parameter;
  if (!model_ || at != at_) model_ = varied_.model_at(at);
  at_ = at;
  return *model_;
}

double PathReader::value(const SoughtQuantity& quantity, const PathPoint& point) {
  if (quantity.kind == SoughtQuantity::Kind::measure) {
    return quantities_at(model(point), point.x, {}, {quantity}).front();
  }
  const auto at = varied_.model_at(point.parameter);
  std::vector<int> active = point.active_stops;
  const int driven = varied_.is_driven() ? static_cast<int>(at->scene().stops.size()) - 1 : -1;
  if (driven >= 0) active.push_back(driven);
  return quantities_at(*at, point.x, active, {quantity}, driven).front();
}

Scene named_scene(const VariedScene& varied) {
  Scene out = varied.scene();
  if (!varied.is_driven()) return out;
  const std::string& name = varied.name();
  const bool has_kind = name.starts_with("angle.") || name.starts_with("travel.") || name.starts_with("drive.");
  Drive drive;
  drive.name = has_kind ? name.substr(name.find('.') + 1) : name;
  drive.on = out.stops.back().on;
  out.drives = {std::move(drive)};
  out.stops.pop_back();
  return out;
}

SoughtQuantity most_changing(const VariedScene& varied, const Path& path) {
  PathReader reader(varied);
  std::vector<SoughtQuantity> measures;
  std::vector<double> least, most;
  const auto read = [&](const PathPoint& point) {
    const StaticModel& model = reader.model(point);
    if (measures.empty()) {
      measures = moving_measures(model);
      least.assign(measures.size(), std::numeric_limits<double>::infinity());
      most.assign(measures.size(), -std::numeric_limits<double>::infinity());
    }
    std::vector<BodyPose<double>> poses = model.poses(point.x);
    poses.resize(model.scene().bodies.size());
    for (std::size_t k = 0; k < measures.size(); ++k) {
      const double value = value_of(model.scene(), measures[k].on, poses);
      least[k] = std::min(least[k], value);
      most[k] = std::max(most[k], value);
    }
  };
  for (const PathBranch& branch : path.branches) {
    for (const PathPoint& point : branch.points) read(point);
  }
  std::size_t best = 0;
  double widest = -1.0;
  for (std::size_t k = 0; k < measures.size(); ++k) {
    const double change = (most[k] - least[k]) / (measures[k].on.is_angle() ? 1.0 : varied.scales().length);
    // Of two that change alike, as the halves of a symmetric mechanism do, rounding does not choose.
    constexpr double alike = 1e-9;
    if (change <= (1 + alike) * widest) continue;
    widest = change;
    best = k;
  }
  return measures.at(best);
}

}  // namespace poise
