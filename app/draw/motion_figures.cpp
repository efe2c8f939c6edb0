#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/followed.hpp"
#include "app/draw/frames.hpp"
#include "app/draw/motion_pictures.hpp"
#include "app/draw/stage.hpp"
#include "motion/courses.hpp"
#include "motion/forces_in_time.hpp"
#include "statics/bodies/body_measures.hpp"

namespace poise::app {
namespace {

constexpr double usual_seconds = 8.0;

/// A cursor for every panel: a vertical line at the x of each frame.
Charts with_cursors(std::vector<Panel> panels, const std::vector<double>& x) {
  Charts charts{.panels = std::move(panels)};
  charts.cursors.assign(charts.panels.size(), {.x = x});
  return charts;
}

/// The place on the first path of a panel at each of these samples; nowhere where there are several.
ChartCursor cursor_on_path(const Panel& paths, const std::vector<std::size_t>& samples) {
  ChartCursor out;
  if (paths.curves.size() != 1) return out;
  for (const std::size_t k : samples) {
    out.x.push_back(paths.curves.front().x[k]);
    out.y.push_back(paths.curves.front().y[k]);
  }
  return out;
}

std::string caption_of(const std::string& name, double value, const std::string& unit) {
  return fmt::format("{} = {} {}", name, significant(value, 4), unit);
}

std::string up_to_stop(const Scene& scene, const std::optional<MetStop>& stop) {
  return stop ? fmt::format(", at the stop \"{}\"", scene.stops[stop->stop].name) : "";
}

/// Times at which a motion is shown: so many that a swing of what moves most often takes 25 frames at least, if that
/// fits.
std::vector<double> frame_times(const MotionRecord& record, double end, std::size_t most) {
  constexpr std::size_t usual = 120, per_swing = 25;
  constexpr double visible = 0.05;  // part of the widest swing
  std::size_t turns = 0;
  for (const Quantity quantity : {Quantity::angle, Quantity::length}) {
    double widest = 0.0;
    const auto width_of = [&](std::size_t c) {
      const auto [low, high] = std::minmax_element(record.value[c].begin(), record.value[c].end());
      return record.value[c].empty() ? 0.0 : *high - *low;
    };
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      if (record.channels[c].quantity == quantity) widest = std::max(widest, width_of(c));
    }
    for (std::size_t c = 0; c < record.channels.size(); ++c) {
      if (record.channels[c].quantity != quantity || width_of(c) <= visible * widest) continue;
      std::size_t own = 0;
      double turned_at = record.value[c].front();
      for (std::size_t k = 1; k < record.rate[c].size(); ++k) {
        if (record.rate[c][k - 1] * record.rate[c][k] >= 0.0) continue;
        if (std::abs(record.value[c][k] - turned_at) > visible * widest) ++own;
        turned_at = record.value[c][k];
      }
      turns = std::max(turns, own);
    }
  }
  const std::size_t frames = std::min(most, std::max(usual, per_swing * turns / 2));
  std::vector<double> times;
  for (std::size_t k = 0; k < frames; ++k)
    times.push_back(end * static_cast<double>(k) / static_cast<double>(frames - 1));
  return times;
}

/// Where the bodies are in a motion.
class PosesInTime {
 public:
  PosesInTime(const MotionModel& model, const Motion& motion)
      : model_(model), count_(static_cast<std::size_t>(motion.trajectory.coordinates)), reader_(reader_of(motion)) {}

  Poses at(double t) {
    reader_.at(t);
    std::vector<double> q;
    for (std::size_t i = 0; i < count_; ++i) q.push_back(reader_.q(i));
    return model_.poses(model_.from_si(std::move(q)));
  }

 private:
  static TrajectoryReader reader_of(const Motion& motion) {
    std::vector<int> all(static_cast<std::size_t>(motion.trajectory.coordinates));
    std::iota(all.begin(), all.end(), 0);
    return {motion.trajectory, all, false};
  }

  const MotionModel& model_;
  std::size_t count_;
  TrajectoryReader reader_;
};

/// The first frame that is not before an event.
std::size_t frame_of(double t, const std::vector<double>& times) {
  const auto found = std::lower_bound(times.begin(), times.end(), t);
  return static_cast<std::size_t>(std::min(found, std::prev(times.end())) - times.begin());
}

/// Where a stop acts, m in the world.
Vec2 place_of(const Scene& scene, const Stop& stop, const Poses& poses) {
  const UnitEffort effort = unit_efforts(scene, stop.on, poses).back();
  return stop.on.is_angle() ? pivot_of(scene, readings_of(scene, poses), effort.body_a, effort.body_b) : effort.b;
}

/// Gives the pictures the signs of impacts, each for so long that the eye catches it.
void add_impacts(std::vector<Position>& positions, const Play& play, const MotionModel& model, const Motion& motion) {
  constexpr double seconds_shown = 0.35;
  const Scene& scene = model.scene();
  const auto is_impact = [](const ContactEvent& event) {
    return event.kind == ContactEvent::Kind::impact && event.impulse != 0.0;
  };
  const auto stop_of = [&](const ContactEvent& event) -> const Stop& {
    return scene.stops[static_cast<std::size_t>(event.at.stop)];
  };
  double largest_force = 0.0, largest_moment = 0.0;  // over a time
  for (const ContactEvent& event : motion.events) {
    if (!is_impact(event)) continue;
    double& largest = stop_of(event).on.is_angle() ? largest_moment : largest_force;
    largest = std::max(largest, std::abs(event.impulse));
  }
  const auto frames = std::max<std::size_t>(
      1, static_cast<std::size_t>(seconds_shown / play.seconds * static_cast<double>(positions.size())));
  PosesInTime poses(model, motion);
  for (const ContactEvent& event : motion.events) {
    if (!is_impact(event)) continue;
    const Stop& stop = stop_of(event);
    const double largest = stop.on.is_angle() ? largest_moment : largest_force;
    const std::size_t first = frame_of(event.t, play.values);
    const Vec2 at = place_of(scene, stop, poses.at(event.t));
    for (std::size_t k = first; k < std::min(first + frames, positions.size()); ++k) {
      std::vector<ImpactSign>& there = positions[k].picture.impacts;
      // The first of bounces that follow each other quickly stands for all: it is the largest.
      const bool is_there = std::any_of(there.begin(), there.end(), [&](const ImpactSign& other) {
        return static_cast<int>(other.stop) == event.at.stop;
      });
      if (is_there) continue;
      there.push_back({.stop = static_cast<std::size_t>(event.at.stop),
                       .at = at,
                       .size = std::abs(event.impulse) / largest,
                       .faded = static_cast<double>(k - first) / static_cast<double>(frames),
                       .impulse = event.impulse});
    }
  }
}

/// "impact of floor (min), 0.62 N s".
std::string caption_of(const ContactEvent& event, const Scene& scene) {
  const Stop& stop = scene.stops[static_cast<std::size_t>(event.at.stop)];
  std::string out = fmt::format("{} of {}", words_of(event, stop), side_of(event, stop));
  if (event.impulse == 0.0) return out;
  const Quantity effort = effort_of(stop.on);
  const double impulse = in_unit(event.impulse, effort, scene.units);
  const ReadableUnit unit = readable_unit(std::abs(impulse), unit_name(effort, scene.units));
  return out + fmt::format(", {} {} s", significant(unit.factor * impulse, 4), unit.unit);
}

/// The events of stops, numbered as in the table and the chart of energies. What one frame shows first has one mark,
/// and the caption of its first event.
std::vector<Play::Mark> marks_of(const Motion& motion, const Scene& scene, const std::vector<double>& times) {
  std::vector<Play::Mark> out;
  const std::vector<ContactEvent>& events = motion.events;
  for (std::size_t k = 0; k < events.size();) {
    const std::size_t frame = frame_of(events[k].t, times);
    std::size_t behind = k + 1;
    while (behind < events.size() && frame_of(events[behind].t, times) == frame) ++behind;
    Play::Mark mark{.frame = frame,
                    .label = std::to_string(k + 1),
                    .caption = fmt::format("t = {} s, {}", significant(events[k].t, 4), caption_of(events[k], scene))};
    if (behind == k + 2) mark.caption += "; " + caption_of(events[k + 1], scene);
    if (behind > k + 2) mark.caption += fmt::format("; {} more", behind - k - 1);
    if (behind > k + 1) mark.label += fmt::format("\u2013{}", behind);
    out.push_back(std::move(mark));
    k = behind;
  }
  return out;
}

}  // namespace

Figure kinematics_figure(const Scene& scene, const KinematicsResult& found, const std::vector<DriveRange>& ranges,
                         const std::vector<std::string>& points, bool confirmed) {
  if (found.samples.empty()) return {};
  const Course drive = drive_course(scene, found, 0, ranges);
  const std::string unit = unit_name(drive.quantity, scene.units);
  const std::vector<double> values = in_unit(drive.value, drive.quantity, scene.units);
  Play play{.label = drive.name, .unit = unit, .seconds = usual_seconds};
  std::vector<Position> positions;
  const std::vector<std::size_t> shown = evenly(found.samples.size(), most_frames(scene, false));
  for (const std::size_t k : shown) {
    Position& position = positions.emplace_back();
    position.scene = &scene;
    position.picture = {.poses = poses_of(found.samples[k].bodies),
                        .heading = caption_of(drive.name, values[k], unit),
                        .confirmed = confirmed,
                        .loads = false};
    play.values.push_back(values[k]);
  }
  positions.back().picture.heading += up_to_stop(scene, found.stop);
  Figure figure{.title = "Driven motion"};
  if (points.empty()) {
    figure.charts = with_cursors(kinematics_panels(scene, found, ranges), play.values);
  } else {
    figure.charts = with_cursors(point_panels(scene, found, ranges, points), play.values);
    figure.charts.cursors.front() = cursor_on_path(figure.charts.panels.front(), shown);
  }
  animate(figure, std::move(positions), std::move(play), "The mechanism over the driven range", points);
  return figure;
}

Figure motion_figure(const Scene& scene, const MotionModel& model, const Motion& motion, const MotionRecord& record,
                     std::vector<Panel> panels, bool confirmed) {
  const Trajectory& path = motion.trajectory;
  if (path.nodes() < 2) return {};
  PosesInTime poses(model, motion);
  Play play{
      .label = "time", .unit = "s", .values = frame_times(record, path.t.back(), most_frames(model.scene(), false))};
  std::vector<Position> positions;
  for (const double t : play.values) {
    Position& position = positions.emplace_back();
    position.scene = &model.scene();
    position.picture = {
        .poses = poses.at(t), .heading = caption_of("t", t, "s"), .confirmed = confirmed, .loads = false};
  }
  constexpr double shortest = 2.0, longest = 30.0;
  const double duration = path.t.back();
  play.seconds = duration >= shortest && duration <= longest ? duration : usual_seconds;
  if (!motion.touched.empty()) {
    std::vector<std::vector<TouchingForce>> touching = touching_forces(scene, model, motion, play.values);
    for (std::size_t k = 0; k < positions.size(); ++k) positions[k].picture.touching = std::move(touching[k]);
  }
  add_impacts(positions, play, model, motion);
  play.marks = marks_of(motion, model.scene(), play.values);
  Figure figure{.title = "Motion"};
  figure.charts = with_cursors(std::move(panels), play.values);
  animate(figure, std::move(positions), std::move(play), "The mechanism as it moves", {});
  return figure;
}

Figure forces_figure(const Scene& scene, const ForcesAlong& found, bool confirmed) {
  if (found.poses.empty()) return {};
  const bool single = found.at.empty();
  const std::string unit = found.measure ? unit_name(*found.measure, scene.units) : "s";
  const std::vector<double> values = found.measure ? in_unit(found.at, *found.measure, scene.units) : found.at;
  Play play{.label = found.along, .unit = unit, .seconds = usual_seconds};
  std::vector<Position> positions;
  for (const std::size_t k : evenly(found.poses.size(), most_frames(scene, true))) {
    const Forces& forces = found.poses[k];
    Position& position = positions.emplace_back();
    position.scene = &scene;
    position.picture = {.poses = poses_of(forces.motions),
                        .heading = single ? "" : caption_of(found.along, values[k], unit),
                        .confirmed = confirmed};
    if (!forces.friction.has_no_forces()) {
      position.picture.reactions = forces.reactions;
      position.picture.drives = forces.drives;
    }
    if (!single) play.values.push_back(values[k]);
  }
  Figure figure{.title = "Forces"};
  if (single) {
    figure.drawing = draw_frames(std::move(positions), "The mechanism with its forces");
    return figure;
  }
  positions.back().picture.heading += up_to_stop(scene, found.stop);
  figure.charts = with_cursors(forces_panels(scene, found), play.values);
  animate(figure, std::move(positions), std::move(play), "The mechanism with its forces as it moves", {});
  return figure;
}

Figure design_figure(const DesignProblem& problem, const DesignResult& best, bool confirmed) {
  if (best.values.empty()) return {};
  const Scene& scene = best.scene;
  const std::vector<DriveRange> range = {
      {scene.bodies[static_cast<std::size_t>(problem.driver)].name, best.from, best.to}};
  KinematicsResult swept;
  try {
    swept = sweep(scene, range);
  } catch (const InputError&) {
    return {};  // it cannot be driven, which the check of the design has said
  }
  Figure figure = kinematics_figure(scene, swept, range, {scene.name_of(problem.guided)}, confirmed);
  figure.title = "The mechanism found";
  return figure;
}

}  // namespace poise::app
