#include "app/results/statics/hold.hpp"

#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/terminal/interrupt.hpp"
#include "model/parameters.hpp"

namespace poise::app {
namespace {

struct HoldRequest {
  Request common;
  std::string vary;
  bool at_rest = false;
};

/// "load.P" or "load.P=0..5"; SI.
struct VariedNumber {
  std::string name;
  double from = -std::numeric_limits<double>::infinity(), to = std::numeric_limits<double>::infinity();
};

VariedNumber read_vary(const std::string& text, const Scene& scene) {
  if (text.find('=') == std::string::npos) return {text};
  const NamedRange range = read_named_range("--vary", text, "NAME or NAME=FROM..TO, say load.P=0..5");
  const double unit = range.name == "loads" ? 1.0 : value_unit(scene, range.name);
  return {range.name, std::min(range.from, range.to) * unit, std::max(range.from, range.to) * unit};
}

void expect_friction(const Scene& scene) {
  if (has_friction(scene)) return;
  throw InputError(scene.file +
                   ": expected friction, found none: give a pin friction = { coefficient = 0.1, radius = 5 }, a slide "
                   "friction = { coefficient = 0.1 }, or add a table [[friction]]");
}

std::vector<double> pose_of(const StaticModel& model, bool at_rest, Progress& progress) {
  if (!at_rest) return assemble(model);
  SolveOptions options;
  options.interrupt = &watch_for_interrupt();
  const Answer answer = search(model, options, progress);
  if (!answer.equilibrium.found()) return {};
  return answer.equilibrium.x;
}

int run_hold(const HoldRequest& request, const Palette& palette) {
  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  expect_friction(model.scene());
  OutputFiles files(request.common);
  HoldView view;
  view.at_rest = request.at_rest;
  const std::vector<double> x = pose_of(model, request.at_rest, progress);
  if (x.empty()) {
    Result none;
    none.title = model.scene().title;
    none.verdict = bad("No equilibrium without friction found, at which friction was to hold.");
    return finish(request.common, none, &files, {}, false, progress, palette);
  }
  progress.now("looking for friction that holds");
  HeldPose pose;
  if (!request.vary.empty()) {
    const VariedNumber varied = read_vary(request.vary, model.scene());
    view.number = varied.name;
    try {
      view.range = held_range(model, x, varied.name, varied.from, varied.to);
    } catch (const InputError& error) {
      throw InputError(std::string("--vary ") + error.what());
    }
    pose = view.range->now;
  } else {
    pose = held_pose(model, x);
  }
  const Result result = hold_result(model, x, pose, view, request.common.settings);
  const bool decided = pose.verdict != Holding::not_decided && pose.proved && (!view.range || view.range->why.empty());
  return finish(request.common, result, &files, {}, decided, progress, palette);
}

}  // namespace

Command hold_command() {
  const auto request = std::make_shared<HoldRequest>();
  Command command{"hold", "Whether friction holds a pose, by what margin, and for which loads"};
  add_scene_options(command, request->common);
  command.add({"--vary", &request->vary, "NAME[=FROM..TO]",
               "The values of a number for which friction holds the pose: load.P,\nbody.B.mass, "
               "slide.S.friction.coefficient; loads: a factor of all loads"});
  command.add({"--at-rest", &request->at_rest, "", "In the equilibrium without friction, not in the pose as drawn"});
  add_output_options(command, request->common, {});
  command.run = [request](const Palette& palette) { return run_hold(*request, palette); };
  return command;
}

}  // namespace poise::app
