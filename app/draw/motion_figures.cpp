#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/followed.hpp"
#include "app/draw/frames.hpp"
#include "app/draw/motion_pictures.hpp"
#include "motion/courses.hpp"

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

Figure motion_figure(const MotionModel& model, const Motion& motion, const MotionRecord& record,
                     std::vector<Panel> panels, bool confirmed) {
  const Trajectory& path = motion.trajectory;
  if (path.nodes() < 2) return {};
  std::vector<int> all(static_cast<std::size_t>(path.coordinates));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  TrajectoryReader reader(path, all, false);
  Play play{
      .label = "time", .unit = "s", .values = frame_times(record, path.t.back(), most_frames(model.scene(), false))};
  std::vector<Position> positions;
  for (const double t : play.values) {
    reader.at(t);
    std::vector<double> q;
    for (std::size_t i = 0; i < all.size(); ++i) q.push_back(reader.q(i));
    Position& position = positions.emplace_back();
    position.scene = &model.scene();
    position.picture = {.poses = model.poses(model.from_si(std::move(q))),
                        .heading = caption_of("t", t, "s"),
                        .confirmed = confirmed,
                        .loads = false};
  }
  constexpr double shortest = 2.0, longest = 30.0;
  const double duration = path.t.back();
  play.seconds = duration >= shortest && duration <= longest ? duration : usual_seconds;
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
