#include "app/results/statics/check.hpp"

#include <exception>
#include <memory>
#include <string>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/equilibrium_figure.hpp"
#include "app/draw/mechanism.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {
namespace {

int run_check(const Request& request, const Palette& palette) {
  Progress progress(request.listener());
  progress.now("reading the scene");
  const Scene moving = load_moving_scene(request);
  const StaticModel model(moving);
  outputs_of(moving);  // throws where one is no quantity
  OutputFiles files(request);
  progress.now("analysing its mobility");
  const Mobility mobility = analyse_mobility(model);
  const Result result = check_result(model, mobility, moving, request.settings);
  // The error of solve where the scene cannot be assembled: then the report shows why, and no file is written. A scene
  // without loads can be checked, and so can a structure.
  std::exception_ptr error;
  try {
    const bool is_structure = mobility.assembled && mobility.freedoms == 0;
    if (!is_structure) assemble(model);
  } catch (const InputError&) {
    error = std::current_exception();
  }
  Pictures pictures;
  if (files.wants_svg()) {
    pictures.svg = draw_mechanism(
        model.scene(),
        {.poses = model.poses(mobility.x), .heading = result.verdict.text, .confirmed = mobility.assembled});
  }
  if (files.wants_html()) pictures.figures = {assembled_figure(model, mobility)};
  const int code = finish(request, result, error ? nullptr : &files, pictures, true, progress, palette);
  if (error) std::rethrow_exception(error);
  return code;
}

}  // namespace

Command check_command() {
  const auto request = std::make_shared<Request>();
  Command command{"check", "Show what a scene is: bodies, joints, mobility, what the model keeps"};
  add_scene_options(command, *request);
  add_output_options(command, *request, {.svg = "Draw the mechanism as it is assembled into FILE"});
  command.run = [request](const Palette& palette) { return run_check(*request, palette); };
  return command;
}

}  // namespace poise::app
