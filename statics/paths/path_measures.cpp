#include "statics/paths/path_measures.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/quantities/linear_response.hpp"

namespace poise {
namespace {

/// Angles of bodies that can turn and all travels, or else coordinates of points.
std::vector<SoughtQuantity> moving_measures(const StaticModel& model) {
  std::vector<SoughtQuantity> out, coordinates;
  for (SoughtQuantity& one : all_quantities(model.scene())) {
    if (one.kind != SoughtQuantity::Kind::measure) continue;
    const Measure& on = one.on;
    const bool is_angle_of_body = on.kind == Measure::Kind::angle && on.body_a == 0 && one.name.starts_with("angle.");
    const bool is_travel = on.kind == Measure::Kind::travel && one.name.starts_with("travel.");
    if ((is_angle_of_body && model.layout().links[on.body_b].frame >= 0) || is_travel)
      out.push_back(std::move(one));
    else if (on.kind == Measure::Kind::x || on.kind == Measure::Kind::y)
      coordinates.push_back(std::move(one));
  }
  return out.empty() ? coordinates : out;
}

/// Forces of elements and sizes of joint forces.
std::vector<SoughtQuantity> forces_of(const Scene& scene) {
  std::vector<SoughtQuantity> out;
  for (SoughtQuantity& one : all_quantities(scene)) {
    const bool is_size =
        one.kind == SoughtQuantity::Kind::reaction && std::count(one.name.begin(), one.name.end(), '.') == 1;
    if (is_size || one.kind == SoughtQuantity::Kind::element_force) out.push_back(std::move(one));
  }
  return out;
}

/// Finds which of these changes most over some points of the path; nothing where none changes visibly.
std::optional<SoughtQuantity> most_changing_force(const VariedScene& varied, const Path& path) {
  std::vector<const PathPoint*> points;
  for (const PathBranch& branch : path.branches) {
    for (const PathPoint& point : branch.points) points.push_back(&point);
  }
  constexpr std::size_t most_points = 20;
  const std::size_t step = 1 + points.size() / most_points;
  const std::vector<SoughtQuantity> forces = forces_of(named_scene(varied));
  std::vector<double> least(forces.size(), std::numeric_limits<double>::infinity());
  std::vector<double> most(forces.size(), -std::numeric_limits<double>::infinity());
  PathReader reader(varied);
  for (std::size_t i = 0; i < points.size(); i += step) {
    const std::vector<QuantityValue> values = reader.values(forces, *points[i]);
    for (std::size_t k = 0; k < forces.size(); ++k) {
      least[k] = std::min(least[k], values[k].value);
      most[k] = std::max(most[k], values[k].value);
    }
  }
  std::optional<SoughtQuantity> best;
  constexpr double visible = 1e-6;  // of the forces and sizes of the mechanism
  double widest = visible;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const double change = (most[k] - least[k]) * forces[k].dimension.per_scale(varied.scales());
    if (!(change > widest)) continue;
    widest = change;
    best = forces[k];
  }
  return best;
}

}  // namespace

const StaticModel& PathReader::model(const PathPoint& point) {
  // Poses do not depend on loads, stiffnesses and driven measures.
  const double at = varied_.is_affine() ? varied_.generic() : point.parameter;
  if (!model_ || at != at_) model_ = varied_.model_at(at);
  at_ = at;
  return *model_;
}

std::vector<QuantityValue> PathReader::values(const std::vector<SoughtQuantity>& of, const PathPoint& point) {
  const int driven = varied_.is_driven() ? static_cast<int>(varied_.scene().stops.size()) - 1 : -1;
  std::vector<int> active = point.active_stops;
  if (driven >= 0) active.push_back(driven);
  if (others_ && std::any_of(of.begin(), of.end(), is_found_by_others)) {
    const std::unique_ptr<StaticModel> there = varied_.model_at(point.parameter);
    return quantity_values(resting_place(*there, point.x, active, driven, others_), of);
  }
  RestingPlace place{scaled(varied_.scene_at(point.parameter), varied_.scales()),
                     varied_.scales(),
                     poses_of(model(point), point.x),
                     std::move(active),
                     driven,
                     {},
                     {}};
  return quantity_values(place, of);
}

Scene named_scene(const VariedScene& varied) {
  Scene out = varied.scene();
  if (!varied.is_driven()) return out;
  const std::string& name = varied.name();
  // A body, a joint and a drive have names; other measures are called by all of theirs.
  const std::string item = name.substr(name.find('.') + 1);
  const auto is_called = [&](const auto& one) { return one.name == item; };
  const bool has_kind = (name.starts_with("angle.") && std::any_of(out.bodies.begin(), out.bodies.end(), is_called)) ||
                        (name.starts_with("travel.") && std::any_of(out.joints.begin(), out.joints.end(), is_called)) ||
                        name.starts_with("drive.");
  Drive drive;
  drive.name = has_kind ? item : name;
  drive.on = out.stops.back().on;
  out.stops.pop_back();
  return naming_drives(std::move(out), {drive});
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
  constexpr double visible = 1e-6;
  if (widest < visible) {
    if (std::optional<SoughtQuantity> force = most_changing_force(varied, path)) return *std::move(force);
  }
  return measures.at(best);
}

}  // namespace poise
