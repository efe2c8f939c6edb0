#include "app/commands/kinematics.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/drive_option.hpp"
#include "app/commands/scene_options.hpp"
#include "app/commands/session.hpp"
#include "app/interrupt.hpp"
#include "app/kinematics_files.hpp"
#include "app/report/kinematics_report.hpp"

namespace poise::app {
namespace {

struct KinematicsRequest {
  Request common;
  std::vector<std::string> drives, points;
  int steps = 72;
  std::optional<double> rate;
};

constexpr int most_steps = 1000000;

int run_kinematics(const KinematicsRequest& request, const Palette& palette) {
  if (request.steps < 1 || request.steps > most_steps) {
    throw InputError(fmt::format("--steps: expected a number from 1 to {}, found {}", most_steps, request.steps));
  }
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the scene");
  const Scene scene = load_scene(request.common);
  std::vector<DriveRange> ranges;
  for (const std::string& text : request.drives) ranges.push_back(read_drive(text, scene));
  OutputFiles files(request.common);
  SweepOptions options;
  options.steps = request.steps;
  options.interrupt = &watch_for_interrupt();
  if (request.rate) {
    if (!(*request.rate > 0.0) || !std::isfinite(*request.rate)) {
      throw InputError(fmt::format("--rate: expected a number > 0, found {}", *request.rate));
    }
    options.rate = *request.rate * unit_value(quantity_of(find_drive(scene, ranges.front().name).on), scene.units);
  }
  progress.now("driving the mechanism");
  const KinematicsResult result = sweep(scene, ranges, options);
  const std::string report = kinematics_report(scene, result, ranges, options.rate, request.points, palette);

  progress.now("writing the result");
  const bool any = !result.samples.empty();
  const std::string written =
      files.write(files.wants_json() ? kinematics_json(scene, result, ranges, request.common.settings) : "",
                  files.wants_svg() && any ? draw_plot(kinematics_panels(scene, result, ranges), 1) : "",
                  files.wants_csv() && any ? kinematics_csv(scene, result, ranges) : "");
  progress.done();
  print(report + (written.empty() ? "" : "\n" + written));
  return result.complete || result.stop ? solved : not_solved;
}

}  // namespace

Command kinematics_command() {
  const auto request = std::make_shared<KinematicsRequest>();
  Command command{"kinematics", "Drive a mechanism over a range: positions, velocities, accelerations"};
  add_scene_options(command, request->common);
  command.add({"--drive", &request->drives, "NAME=FROM..TO",
               "Drive the angle of a body, or the travel of a joint, in the\nscene's units: crank=0..360; one for each "
               "degree of freedom;\nends where a stop is met",
               Presence::required});
  command.add({"--steps", &request->steps, "N", "Equal parts of the range (72)"});
  command.add({"--rate", &request->rate, "NUMBER",
               "Speed of the first drive that moves, scene's units per second\n(1 rad/s or 1 m/s)"});
  command.add({"--point", &request->points, "BODY.POINT", "Show this point too: crank.B; several times"});
  command.add({"--csv", &request->common.csv, "FILE", "Write all samples, one line each, to FILE"});
  command.add({"--json", &request->common.json, "FILE", "Write the result to FILE as JSON"});
  command.add({"--svg", &request->common.svg, "FILE", "Draw coordinates and their derivatives into FILE"});
  command.run = [request](const Palette& palette) { return run_kinematics(*request, palette); };
  return command;
}

}  // namespace poise::app
