#include "app/results/motion/modes.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/modes_figure.hpp"
#include "motion/equilibrium_pose.hpp"

namespace poise::app {
namespace {

struct ModesRequest {
  Request common;
  std::string seek = "settle";
};

int run_modes(const ModesRequest& request, const Palette& palette) {
  SolveOptions options;
  options.seek = read_seek(request.seek);
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const StaticModel statics(load_scene(request.common));
  const MotionModel model(statics.scene());
  OutputFiles files(request.common);
  options.interrupt = &request.common.interrupt();

  progress.now("looking for the equilibrium");
  ModesAnswer answer;
  answer.equilibrium = solve(statics, options);
  if (answer.equilibrium.found()) {
    progress.now("analysing small motions");
    answer.x = motion_coordinates(model, statics, answer.equilibrium.x);
    answer.modes = modes_of(model, answer.x);
  }
  const Result result = modes_result(model, answer, request.common.settings);
  Pictures pictures;
  if (files.wants_html() && answer.modes.known) {
    pictures.figures = {modes_figure(model, answer.x, answer.modes, answer.equilibrium.found())};
  }
  return finish(request.common, result, &files, pictures, answer.modes.known, progress, palette);
}

}  // namespace

Command modes_command() {
  const auto request = std::make_shared<ModesRequest>();
  Command command{"modes", "Find small oscillations about equilibrium: frequencies, shapes, damping"};
  add_scene_options(command, request->common);
  add_seek_option(command, request->seek);
  add_output_options(command, request->common, {});
  command.run = [request](const Palette& palette) { return run_modes(*request, palette); };
  return command;
}

}  // namespace poise::app
