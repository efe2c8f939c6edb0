#include "app/results/motion/kinematics.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/chart/motion_charts.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/motion_pictures.hpp"

namespace poise::app {
namespace {

struct KinematicsRequest {
  Request common;
  std::vector<std::string> drives;
  KinematicsView view;
  int steps = 72;
  std::optional<double> rate;
  std::vector<std::string> show;
};

int run_kinematics(const KinematicsRequest& request, const Palette& palette) {
  check_sweep(request.steps, request.rate);
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene scene = load_scene(request.common);
  std::vector<DriveRange> ranges;
  for (const std::string& text : request.drives) ranges.push_back(read_drive(text, scene));
  KinematicsView view = request.view;
  std::vector<Drive> drives;
  for (const DriveRange& range : ranges) drives.push_back(find_drive(scene, range.name));
  view.show = read_shown_in_position(request.show, naming_drives(scene, drives));
  OutputFiles files(request.common);
  SweepOptions options;
  options.steps = request.steps;
  options.interrupt = &request.common.interrupt();
  if (request.rate) {
    options.rate =
        *request.rate * unit_value(quantity_of(find_drive(scene, ranges[first_moving(ranges)].name).on), scene.units);
  }
  progress.now("driving the mechanism");
  const KinematicsResult found = sweep(scene, ranges, options);
  const Result result = kinematics_result(scene, found, ranges, options.rate, view, request.common.settings);
  const bool reached = found.complete || found.stop;
  Pictures pictures;
  if (files.wants_svg() && !found.samples.empty()) {
    const std::vector<std::string>& points = request.view.points;
    const std::vector<Panel> panels =
        points.empty() ? kinematics_panels(scene, found, ranges) : point_panels(scene, found, ranges, points);
    pictures.svg = stacked(kinematics_picture(scene, found, points, result.verdict.text, reached), draw_plot(panels));
  }
  if (files.wants_html() && !found.samples.empty()) {
    progress.now("drawing");
    pictures.figures = {kinematics_figure(scene, found, ranges, request.view.points, reached)};
  }
  return finish(request.common, result, &files, pictures, reached, progress, palette);
}

}  // namespace

Command kinematics_command() {
  const auto request = std::make_shared<KinematicsRequest>();
  Command command{"kinematics", "Drive a mechanism over a range: positions, velocities, accelerations"};
  add_scene_options(command, request->common);
  command.add({"--drive", &request->drives, "NAME=FROM..TO",
               "Drive the angle of a body in the world, the travel of a joint or\na measure, in the scene's units: "
               "crank=0..360,\nlength.SPRING=200..145, x.BODY.POINT=..., angle.BODY.OTHER=...;\none for each degree of "
               "freedom; ends where a stop is met",
               Presence::required});
  command.add({"--steps", &request->steps, "N", "Equal parts of the range (72)"});
  command.add({"--rate", &request->rate, "NUMBER",
               "Speed of the first drive that moves, scene's units per second\n(1 rad/s or 1 m/s)"});
  command.add({"--point", &request->view.points, "BODY.POINT",
               "Show this point: crank.B; --svg draws its path; several times"});
  add_show_option(command, request->show);
  command.add({"--all", &request->view.all, "", "Show every angle and slide too"});
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism at the start, middle and end of the range, and\nits angles and slides "
                             "over the drive, or the motion of --point, into FILE",
                      .csv = "Write all angles, slides and points, one line for each sample,\nto FILE"});
  command.run = [request](const Palette& palette) { return run_kinematics(*request, palette); };
  return command;
}

}  // namespace poise::app
