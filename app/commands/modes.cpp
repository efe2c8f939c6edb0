#include "app/results/motion/modes.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/modes_figure.hpp"
#include "app/results/motion/control_loop.hpp"
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
  Scene scene = load_scene(request.common);
  OutputFiles files(request.common);
  const std::string_view kept_by = what_keeps(scene);
  const bool is_sought = request.seek != ModesRequest{}.seek;
  if (is_sought && !kept_by.empty() && kept_by != "motors") {
    throw InputError(
        "--seek: with a [[controller]] or a [[blade]] the equilibrium is sought from where the scene is assembled; "
        "leave it out");
  }
  if (!kept_by.empty() && !is_sought) {
    progress.now("analysing the closed loop");
    const MotionModel model(scene);
    if (const std::optional<ControlLoop> loop = loop_where_kept(model)) {
      const Result result = control_loop_result(model, *loop, request.common.settings);
      return finish(request.common, result, &files, {}, loop->known, progress, palette);
    }
  }
  if (!request.common.csv.empty()) {
    throw InputError(
        "--csv: expected a scene with a [[controller]], a [[blade]] or a [[motor]], of whose linear system the "
        "matrices are; leave it out");
  }
  const StaticModel statics(std::move(scene));
  const MotionModel model(statics.scene());
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
  add_output_options(command, request->common,
                     {.csv = "with controllers or blades: the matrices [A B; C D] to FILE, SI"});
  command.run = [request](const Palette& palette) { return run_modes(*request, palette); };
  return command;
}

}  // namespace poise::app
