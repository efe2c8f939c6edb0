#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <list>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/path_chart.hpp"
#include "app/draw/followed.hpp"
#include "app/draw/path_picture.hpp"
#include "statics/model/check.hpp"

namespace poise::app {
namespace {

/// What a frame shows: an equilibrium of the path, or a pose that the mechanism passes as it snaps.
struct Shown {
  PathPoint point{};
  bool snaps = false;
};

/// How far apart two points are: in parts of the range, rad and mechanism sizes.
double distance(const PathPoint& a, const PathPoint& b, double range) {
  const double along = (a.parameter - b.parameter) / range;
  double sum = along * along;
  for (std::size_t i = 0; i < a.x.size(); ++i) sum += (a.x[i] - b.x[i]) * (a.x[i] - b.x[i]);
  return std::sqrt(sum);
}

double length_of(const PathBranch& branch, double range) {
  double sum = 0.0;
  for (std::size_t i = 1; i < branch.points.size(); ++i) sum += distance(branch.points[i - 1], branch.points[i], range);
  return sum;
}

/// The points of a branch that are shown: its ends, its events, and others `step` apart.
std::vector<std::size_t> shown_points(const Path& path, const PathBranch& branch, double step, double range) {
  std::vector<bool> is_event(branch.points.size(), false);
  for (const int e : branch.events) {
    const PathPoint& at = path.events[static_cast<std::size_t>(e)].at;
    const auto nearest = std::min_element(
        branch.points.begin(), branch.points.end(),
        [&](const PathPoint& a, const PathPoint& b) { return distance(a, at, range) < distance(b, at, range); });
    is_event[static_cast<std::size_t>(nearest - branch.points.begin())] = true;
  }
  std::vector<std::size_t> shown;
  double since = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < branch.points.size(); ++i) {
    if (i > 0) since += distance(branch.points[i - 1], branch.points[i], range);
    if (since < step && !is_event[i] && i + 1 < branch.points.size()) continue;
    shown.push_back(i);
    since = 0.0;
  }
  return shown;
}

/// The snap that ends a branch; null where none does.
const PathEvent* snap_of(const Path& path, const PathBranch& branch) {
  if (branch.end != PathBranch::End::snapped || branch.events.empty()) return nullptr;
  return &path.events[static_cast<std::size_t>(branch.events.back())];
}

bool ends_a_branch(const Path& path, const PathEvent& snap) {
  return std::any_of(path.branches.begin(), path.branches.end(),
                     [&](const PathBranch& branch) { return snap_of(path, branch) == &snap; });
}

/// Whether a branch begins at the landing of a snap.
bool goes_on(const Path& path, const PathPoint& landing, double range) {
  constexpr double same = 1e-6;
  return std::any_of(path.branches.begin(), path.branches.end(), [&](const PathBranch& branch) {
    return !branch.points.empty() && distance(branch.points.front(), landing, range) < same;
  });
}

std::string parameter_words(const VariedScene& varied, double value) {
  const std::string unit = varied.unit_name();
  return fmt::format("{} = {}{}{}", varied.name(), significant(value / varied.unit(), 4), unit.empty() ? "" : " ",
                     unit);
}

/// "snaps to handle = 23.4 deg".
std::string snap_words(const VariedScene& varied, const PathEvent& event, const std::vector<SoughtQuantity>& measures) {
  if (!event.landing || measures.empty()) return "snaps";
  PathReader reader(varied);
  const SoughtQuantity& measure = measures.front();
  const Units& units = varied.scene().units;
  return fmt::format("snaps to {} = {} {}", measure.name,
                     significant(reader.value(measure, *event.landing) / measure.dimension.unit(units), 4),
                     measure.dimension.unit_name(units));
}

std::string caption_of(const VariedScene& varied, const Shown& at) {
  const PathPoint& point = at.point;
  if (at.snaps) return parameter_words(varied, point.parameter) + ": snaps";
  const char* proof = point.proof == PointProof::proved     ? "proved"
                      : point.proof == PointProof::critical ? "critical point"
                                                            : "not proved";
  return fmt::format("{}: {}, {}", parameter_words(varied, point.parameter), to_string(point.stability), proof);
}

/// The forces of joints at an equilibrium; none in a snap and where there are too many joints to show them.
std::optional<std::vector<Reaction>> reactions_at(const VariedScene& varied, const Shown& at) {
  constexpr std::size_t most_joints = 24;
  if (at.snaps || varied.scene().joints.size() > most_joints) return {};
  const auto model = varied.model_at(at.point.parameter);
  std::vector<int> active = at.point.active_stops;
  if (varied.is_driven()) active.push_back(static_cast<int>(model->scene().stops.size()) - 1);
  return check(*model, at.point.x, {}, &active).reactions;
}

/// The scene at a point, with a drive in place of the stop that stands for it.
Scene scene_of(const VariedScene& varied, const PathPoint& point) {
  Scene scene = varied.scene_at(point.parameter);
  if (!varied.is_driven()) return scene;
  Drive drive;
  drive.name = scene.stops.back().name;
  drive.on = scene.stops.back().on;
  scene.drives = {drive};
  scene.stops.pop_back();
  return scene;
}

Position position_of(const VariedScene& varied, PathReader& reader, const Scene& scene, const Shown& at) {
  const PathPoint& point = at.point;
  Position position{.scene = &scene};
  MechanismPicture& picture = position.picture;
  picture.poses = reader.model(point).poses(point.x);
  picture.heading = caption_of(varied, at);
  picture.confirmed = at.snaps || point.proof == PointProof::proved || point.proof == PointProof::critical;
  picture.reactions = reactions_at(varied, at);
  if (varied.is_driven() && picture.reactions) {
    const Drive& drive = scene.drives.front();
    picture.drives.push_back({.name = drive.name, .is_angle = drive.on.is_angle(), .value = point.effort});
  }
  if (!picture.confirmed)
    position.tone = Tone::bad;
  else if (!at.snaps && point.stability == Stability::stable)
    position.tone = Tone::good;
  else
    position.tone = Tone::doubtful;
  return position;
}

}  // namespace

Figure path_figure(const VariedScene& varied, const Path& path, const std::vector<SoughtQuantity>& measures) {
  const double range = std::abs(varied.to() - varied.from());
  const PathCharts charts = charts_of(varied, path, measures);
  double length = 0.0;
  for (const PathBranch& branch : path.branches) length += length_of(branch, range);
  const double step = length / static_cast<double>(most_frames(varied.scene(), true));

  Play play{.label = varied.name(), .unit = varied.unit_name()};
  std::vector<Shown> shown;
  const auto add_snap = [&](const PathEvent& snap) {
    if (snap.course.empty()) return;
    const std::size_t first = shown.size();
    for (const std::size_t k : evenly(snap.course.size(), 30)) {
      Shown& at = shown.emplace_back(Shown{.snaps = true});
      at.point.parameter = snap.at.parameter;
      at.point.x = snap.course[k];
      at.point.effort = std::numeric_limits<double>::quiet_NaN();
    }
    play.snaps.push_back({first, shown.size() - 1, snap_words(varied, snap, charts.measures)});
  };
  for (const PathBranch& branch : path.branches) {
    for (const std::size_t i : shown_points(path, branch, step, range)) shown.push_back({branch.points[i]});
    const PathEvent* snap = snap_of(path, branch);
    if (snap != nullptr) add_snap(*snap);
    if (snap != nullptr && snap->landing && !goes_on(path, *snap->landing, range)) shown.push_back({*snap->landing});
  }
  // The curve goes on through a fold, the mechanism does not: what it does there follows behind the curve.
  for (std::size_t e = 0; e < path.events.size(); ++e) {
    const PathEvent& event = path.events[e];
    if (event.kind != PathEvent::Kind::snap || event.course.empty() || !event.landing || ends_a_branch(path, event)) {
      continue;
    }
    play.marks.push_back({shown.size(), fmt::format("{} \u2192", e + 1),
                          fmt::format("the snap at {}", parameter_words(varied, event.at.parameter))});
    shown.push_back({event.at});
    add_snap(event);
    shown.push_back({*event.landing});
  }
  if (shown.empty()) return {};

  PathReader reader(varied);
  std::list<Scene> scenes;
  std::vector<Position> positions;
  std::vector<PathPoint> points;
  for (const Shown& at : shown) {
    scenes.push_back(scene_of(varied, at.point));
    positions.push_back(position_of(varied, reader, scenes.back(), at));
    play.values.push_back(at.point.parameter / varied.unit());
    points.push_back(at.point);
  }
  for (const PathMark& mark : charts.marks) {
    constexpr double same = 1e-3;
    const auto nearest = std::min_element(shown.begin(), shown.end(), [&](const Shown& a, const Shown& b) {
      return distance(a.point, *mark.point, range) < distance(b.point, *mark.point, range);
    });
    if (distance(nearest->point, *mark.point, range) > same) continue;  // on a curve that was not followed
    play.marks.push_back({static_cast<std::size_t>(nearest - shown.begin()), mark.label, mark.caption});
  }
  std::stable_sort(play.marks.begin(), play.marks.end(),
                   [](const Play::Mark& a, const Play::Mark& b) { return a.frame < b.frame; });
  Figure figure{.title = "Along the path of equilibria"};
  figure.charts.panels = charts.panels;
  figure.charts.cursors = path_cursors(varied, charts.measures, points);
  animate(figure, std::move(positions), std::move(play), "The mechanism at the equilibria of the path", {});
  return figure;
}

}  // namespace poise::app
