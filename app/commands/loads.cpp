#include "app/results/statics/loads.hpp"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/commands/vary.hpp"
#include "app/draw/chart/plot.hpp"
#include "app/draw/loads_picture.hpp"
#include "app/results/statics/loads_along.hpp"
#include "motion/dynamic_stability.hpp"

namespace poise::app {
namespace {

struct LoadsRequest {
  Request common;
  std::string seek = "settle";
  std::optional<double> proof_seconds;
  int steps = 10;
  std::vector<std::string> show;
  std::optional<double> time;
  std::string vary;
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
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const MotionModel model(load_moving_scene(request.common));
  expect_links(model.scene());
  OutputFiles files(request.common);
  MotionOptions options;
  options.interrupt = &request.common.interrupt();
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

/// At equal parts of the range of a number, or of a driven measure, as a machine passes them that is loaded slowly.
int run_over_range(const LoadsRequest& request, const Palette& palette) {
  if (!request.show.empty()) {
    throw InputError("--show: not with --vary, which shows loads alone; expected poise path --show for quantities");
  }
  if (request.time) throw InputError("--vary: over a range nothing moves; expected --vary or --time, leave one out");
  if (request.seek != LoadsRequest().seek) {
    throw InputError("--vary: the path begins where the mechanism comes to rest; leave out --seek");
  }
  PathOptions options;
  options.follow = PathOptions::Follow::load;
  options.certificate = read_proof(request.proof_seconds);
  options.dynamic_stability = dynamic_stability;
  if (!request.common.svg.empty()) expect_plotter();
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const VariedScene varied = load_varied_scene(request.common, read_vary_range(request.vary));
  OutputFiles files(request.common);
  options.interrupt = &request.common.interrupt();
  for (int k = 0; k <= request.steps; ++k) {
    options.at.push_back(varied.value_at(static_cast<double>(k) / request.steps));
  }
  progress.now("following the curve of equilibria");
  const LoadsAlong answer = loads_along(varied, options);
  const Result result = loads_along_result(varied, answer, request.common.settings);
  Pictures pictures;
  const std::vector<Panel> panels = answer.loads.empty() ? std::vector<Panel>{} : loads_along_panels(varied, answer);
  if (files.wants_svg() && !panels.empty()) pictures.svg = draw_plot(panels);
  if (files.wants_html() && !answer.loads.empty())
    pictures.figures = {loads_figure(varied, answer, panels, is_complete(answer))};
  return finish(request.common, result, &files, pictures, is_complete(answer), progress, palette);
}

int run_loads(const LoadsRequest& request, const Palette& palette) {
  expect_between("--steps", request.steps, 1, 1000);
  if (!request.vary.empty()) return run_over_range(request, palette);
  if (request.time) return run_in_motion(request, palette);
  SolveOptions options;
  options.seek = read_seek(request.seek);
  options.certificate = read_proof(request.proof_seconds);
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request.common));
  const Scene& scene = model.scene();
  expect_links(scene);
  const std::vector<SoughtQuantity> show = read_shown_in_position(request.show, scene);
  OutputFiles files(request.common);
  options.interrupt = &request.common.interrupt();
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
  command.add({"--steps", &request->steps, "N",
               "Equal parts of each piece of a diagram in JSON and CSV, or of the\nrange of --vary (10)"});
  command.add({"--vary", &request->vary, "NAME=FROM..TO",
               "Over a range of a number or of a driven measure (load.P=0..40,\nangle.BODY=0..90): the smallest and "
               "largest force of every joint and\nthe largest loads of links, and where"});
  command.add({"--time", &request->time, "S",
               "In motion, S seconds after the scene's start, with the inertia of\nthe links (without it: at rest in "
               "the equilibrium)"});
  add_show_option(command, request->show);
  add_proof_option(command, request->proof_seconds);
  add_output_options(
      command, request->common,
      {.svg = "Draw normal force, shear force, bending moment and deflection on the\nmechanism, into FILE",
       .csv = "Write the diagrams, one line for each place, or all forces over a\nrange, to FILE"});
  command.run = [request](const Palette& palette) { return run_loads(*request, palette); };
  return command;
}

}  // namespace poise::app
