#include "app/results/motion/running.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/mechanism.hpp"
#include "app/draw/motion_pictures.hpp"
#include "model/joint_friction.hpp"
#include "motion/motion_record.hpp"

namespace poise::app {
namespace {

/// Instants of a period in the record.
constexpr int instants = 360;

struct RunningRequest {
  Request common;
  std::string turning;
  int turns = 1;
  double speed = 0.0;
  std::vector<std::string> show;
};

/// The body whose turns make the period: the one that is named, or else that of the first motor on an angle.
const Channel& turning_channel(const RunningRequest& request, const Scene& scene,
                               const std::vector<Channel>& channels) {
  std::string name = request.turning;
  for (const Element& element : scene.elements) {
    if (name.empty() && is_motor(element.law) && element.on.kind == Measure::Kind::angle)
      name =
          scene.bodies[static_cast<std::size_t>(element.on.body_b != 0 ? element.on.body_b : element.on.body_a)].name;
  }
  if (name.empty()) {
    throw InputError(scene.file +
                     ": expected a [[motor]] that turns a body; add one, or name a body with --turning BODY");
  }
  const Channel& channel = channel_named("--turning " + name, name, channels);
  if (channel.quantity != Quantity::angle) {
    throw InputError("--turning " + name + ": expected a body that turns, found what moves along a line; name a body");
  }
  return channel;
}

std::vector<SoughtQuantity> joint_forces(const Scene& scene) {
  std::vector<SoughtQuantity> out;
  for (const Joint& joint : scene.joints)
    out.push_back(find_quantity(scene, "reaction." + joint.name + ".size", AskedOf::motion));
  return out;
}

std::vector<SoughtQuantity> motor_efforts(const Scene& scene) {
  std::vector<SoughtQuantity> out;
  for (const Element& element : scene.elements) {
    if (is_motor(element.law)) out.push_back(find_quantity(scene, "force." + element.name, AskedOf::motion));
  }
  return out;
}

/// Forces, speeds and what was asked for over the period that was found.
void look_along(const Scene& scene, const MotionModel& model, const Channel& channel, std::vector<SoughtQuantity> asked,
                RunningAnswer& answer) {
  QuantitiesAlong along(scene, model, answer.found.motion);
  answer.motors = motor_efforts(scene);
  answer.joints = joint_forces(scene);
  std::vector<SoughtQuantity> all = answer.motors;
  all.insert(all.end(), answer.joints.begin(), answer.joints.end());
  answer.ranges = along.ranges(all);
  TrajectoryReader reader(answer.found.motion.trajectory, {channel.coordinate});
  std::vector<double> time;
  for (int k = 0; k <= instants; ++k) {
    time.push_back(answer.found.period * k / instants);
    reader.at(time.back());
    answer.angle.push_back(reader.q(0) + channel.offset);
    answer.speed.push_back(reader.v(0));
  }
  for (const SoughtQuantity& one : answer.motors) {
    const SoughtQuantity work = find_quantity(scene, "work(" + one.name + ")", AskedOf::motion);
    answer.power.push_back(-along.value(work, answer.found.period) / answer.found.period);
  }
  for (SoughtQuantity& one : asked) {
    const bool has =
        std::any_of(all.begin(), all.end(), [&](const SoughtQuantity& other) { return other.name == one.name; });
    if (!has) all.push_back(std::move(one));
  }
  answer.shown = quantities_in_time(all, time, answer.found.period, along);
}

int run_running(const RunningRequest& request, const Palette& palette) {
  expect_between("--turns", request.turns, 1, 1000);
  expect_number("--speed", request.speed, true, "a finite rate");
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const Scene scene = load_moving_scene(request.common);
  const std::vector<SoughtQuantity> asked = read_quantities("--show", request.show, scene, AskedOf::motion);
  for (const SoughtQuantity& one : asked) refuse_at_rest_only(scene, one);
  const MotionModel model(resisted_by_joints(scene));
  refuse_rubbing_ropes(model.scene(), "motion");
  const std::vector<Channel> channels = channels_of(model);
  const Channel& channel = turning_channel(request, model.scene(), channels);
  OutputFiles files(request.common);

  RunningAnswer answer;
  answer.turning = channel.name;
  RunningOptions options;
  options.coordinate = channel.coordinate;
  options.turns = request.turns;
  options.guess = request.speed * scene.units.angle;
  options.interrupt = &request.common.interrupt();
  options.progress = [&](int periods) {
    progress.now_and_then([&] { return fmt::format("running: {} periods", periods); });
  };
  answer.found = steady_running(model, start_motion(model, {}), options);
  answer.turns = answer.found.turns;
  if (answer.found.found) {
    progress.now("finding the forces");
    look_along(scene, model, channel, asked, answer);
  }
  const Result result = running_result(model, answer, request.common.settings);
  Pictures pictures;
  if (answer.found.found) {
    std::vector<Panel> panels = running_panels(scene.units, answer);
    if (files.wants_svg()) {
      pictures.svg = stacked(motion_picture(model, answer.found.motion, result.verdict.text, answer.found.stable),
                             draw_plot(panels));
    }
    if (files.wants_html()) {
      const MotionRecord moving = record(model, answer.found.motion, instants / answer.found.period, false);
      pictures.figures = {motion_figure(scene, model, answer.found.motion, moving, {}, answer.found.stable)};
      for (Figure& figure : chart_figures("Over the period", std::move(panels)))
        pictures.figures.push_back(std::move(figure));
    }
  }
  return finish(request.common, result, &files, pictures, answer.found.found && answer.found.stable, progress, palette);
}

}  // namespace

Command running_command() {
  const auto request = std::make_shared<RunningRequest>();
  Command command{"running", "Find how a machine with motors runs steadily: speed over a turn, forces, stability"};
  add_scene_options(command, request->common);
  command.add(
      {"--turning", &request->turning, "BODY", "The body whose turns make the period (that of the first motor)"});
  command.add({"--turns", &request->turns, "N", "Turns of it in a period (1)"});
  command.add({"--speed", &request->speed, "RATE",
               "Start at this rate of it, in the scene's unit of angle per second;\nwithout it from rest, where the "
               "motors have to start it"});
  add_show_option(command, request->show);
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism, and its speed and forces over the turn, into\nFILE",
                      .csv = "Write angle, speed and forces at 361 instants of the period to FILE"});
  command.run = [request](const Palette& palette) { return run_running(*request, palette); };
  return command;
}

}  // namespace poise::app
