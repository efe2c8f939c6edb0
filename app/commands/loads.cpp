#include "app/results/statics/loads.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/loads_picture.hpp"
#include "app/terminal/interrupt.hpp"

namespace poise::app {
namespace {

struct LoadsRequest {
  Request common;
  std::string seek = "settle";
  std::optional<double> proof_seconds;
  int steps = 10;
  std::vector<std::string> show;
  std::optional<double> time;
};

void expect_links(const Scene& scene) {
  if (has_links(scene)) return;
  throw InputError(scene.file +
                   ": expected a body with a section; add [body.NAME.section] with profile = \"IPE 80\" and modulus");
}

/// At a time of the motion that the drives and loads make of the scene's start.
int run_in_motion(const LoadsRequest& request, const Palette& palette) {
  expect_number("--time", *request.time, *request.time >= 0, "a time in s, 0 or more");
  if (!request.show.empty()) {
    throw InputError("--time: quantities are shown at rest; leave out --show, or see poise motion");
  }
  if (request.proof_seconds || request.seek != LoadsRequest().seek) {
    throw InputError("--time: in motion no equilibrium is sought; leave out --seek and --proof-seconds");
  }
  Progress progress;
  progress.now("reading the scene");
  const MotionModel model(load_moving_scene(request.common));
  expect_links(model.scene());
  if (!model.scene().flexible_links.empty()) {
    throw InputError(
        fmt::format("{}: \"{}\" bends, and in motion only rigid links have internal loads; expected no "
                    "flexible = true with --time",
                    model.scene().file, model.scene().flexible_links.front().name));
  }
  OutputFiles files(request.common);
  MotionOptions options;
  options.interrupt = &watch_for_interrupt();
  progress.now("moving");
  const MovingLoadsAnswer answer{*request.time,
                                 loads_in_motion(model, start_motion(model, {}), *request.time, options)};
  const LoadsInMotion& found = answer.found;
  const Result result = loads_result(model, answer, request.steps, request.common.settings);
  Pictures pictures;
  const bool drawn = found.why.empty();
  if (files.wants_svg() && drawn) {
    pictures.svg = loads_picture(model.scene(), found.poses, found.links, result.verdict.text, answer.is_complete());
  }
  if (files.wants_html() && drawn) {
    pictures.figures = {loads_figure(model.scene(), found.poses, found.links, answer.is_complete())};
  }
  return finish(request.common, result, &files, pictures, answer.is_complete(), progress, palette);
}

int run_loads(const LoadsRequest& request, const Palette& palette) {
  expect_between("--steps", request.steps, 1, 1000);
  if (request.time) return run_in_motion(request, palette);
  SolveOptions options;
  options.seek = read_seek(request.seek);
  options.certificate = read_proof(request.proof_seconds);
  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  const Scene& scene = model.scene();
  expect_links(scene);
  const std::vector<SoughtQuantity> show = read_shown_in_position(request.show, scene);
  OutputFiles files(request.common);
  options.interrupt = &watch_for_interrupt();
  progress.now("solving");
  LoadsAnswer answer{solve_or_hold(model, options), {}};
  const Equilibrium& equilibrium = answer.equilibrium;
  const bool stands = equilibrium.found() || equilibrium.status == Status::checked;
  if (stands) answer.links = link_loads(scene, model.poses(equilibrium.x), equilibrium.check);
  const Result result = loads_result(model, answer, request.steps, show, request.common.settings);
  Pictures pictures;
  const bool confirmed = answer.is_complete();
  if (files.wants_svg() && stands) {
    pictures.svg = loads_picture(scene, model.poses(equilibrium.x), answer.links, result.verdict.text, confirmed);
  }
  if (files.wants_html() && stands)
    pictures.figures = {loads_figure(scene, model.poses(equilibrium.x), answer.links, confirmed)};
  const bool interrupted = equilibrium.status == Status::interrupted;
  return finish(request.common, result, interrupted ? nullptr : &files, pictures, confirmed, progress, palette);
}

}  // namespace

Command loads_command() {
  const auto request = std::make_shared<LoadsRequest>();
  Command command{"loads", "Find internal forces, moments, stresses and deflections of links"};
  add_scene_options(command, request->common);
  add_seek_option(command, request->seek);
  command.add({"--steps", &request->steps, "N", "Equal parts of each piece of a diagram in JSON and CSV (10)"});
  command.add({"--time", &request->time, "S",
               "In motion, S seconds after the scene's start, with the inertia of\nthe links (without it: at rest in "
               "the equilibrium)"});
  add_show_option(command, request->show);
  add_proof_option(command, request->proof_seconds);
  add_output_options(
      command, request->common,
      {.svg = "Draw normal force, shear force, bending moment and deflection on the\nmechanism, into FILE",
       .csv = "Write the diagrams, one line for each place, to FILE"});
  command.run = [request](const Palette& palette) { return run_loads(*request, palette); };
  return command;
}

}  // namespace poise::app
