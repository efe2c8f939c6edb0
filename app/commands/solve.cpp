#include "app/results/statics/solve.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/equilibrium_figure.hpp"
#include "app/terminal/interrupt.hpp"

namespace poise::app {
namespace {

struct SolveRequest {
  Request common;
  std::string method = "virtual-work", seek = "settle";
  std::optional<double> proof_seconds;
  std::optional<double> time;
  std::vector<std::string> show;
};

/// The scene at the time asked for. Throws InputError where nothing of it depends on time.
Scene scene_at_time(const SolveRequest& request) {
  Scene scene = load_moving_scene(request.common);
  if (!request.time) return at_time(std::move(scene), 0.0);
  expect_number("--time", *request.time, true, "a time, s");
  const bool has_loads = std::any_of(scene.time_functions.begin(), scene.time_functions.end(),
                                     [](const auto& one) { return one.of != TimeFunction::Of::drive; });
  if (!has_loads) {
    throw InputError(
        "--time: no load of the scene follows a function of time; expected one with the key time, or no "
        "--time");
  }
  return at_time(std::move(scene), *request.time);
}

int run_solve(const SolveRequest& words, const Palette& palette) {
  const Request& request = words.common;
  SolveOptions options;
  options.method = read_method("--method", words.method);
  options.seek = read_seek(words.seek);
  options.certificate = read_proof(words.proof_seconds);

  Progress progress;
  progress.now("reading the scene");
  const StaticModel model(scene_at_time(words));
  const std::vector<SoughtQuantity> show = read_shown_in_position(words.show, model.scene());
  OutputFiles files(request);
  options.interrupt = &watch_for_interrupt();
  const Answer answer = search(model, options, progress);

  std::optional<HeldPose> as_drawn;
  if (has_friction(model.scene())) as_drawn = held_pose(model, assemble(model));
  const Result result = solve_result(model, answer, request.settings, as_drawn ? &*as_drawn : nullptr, show);
  const bool interrupted = answer.equilibrium.status == Status::interrupted;
  const bool drawn = answer.readings && !interrupted;
  Pictures pictures;
  if (files.wants_svg() && drawn) pictures.svg = picture(model, answer, show);
  if (files.wants_html() && drawn) {
    pictures.figures = {equilibrium_figure(model, answer.equilibrium, assemble(model))};
  }
  const bool is_solved = answer.equilibrium.found() || answer.equilibrium.status == Status::checked;
  return finish(request, result, interrupted ? nullptr : &files, pictures, is_solved, progress, palette);
}

}  // namespace

Command solve_command() {
  const auto request = std::make_shared<SolveRequest>();
  Command command{"solve", "Find an equilibrium and the forces in it, by one method"};
  add_scene_options(command, request->common);
  add_seek_option(command, request->seek);
  command.add({"--method", &request->method, "METHOD", "One of these, the first by default\n" + method_help()});
  command.add({"--time", &request->time, "S", "Time at which loads that follow functions of time are taken (0)"});
  add_show_option(command, request->show);
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism in equilibrium, with loads and joint forces, into\nFILE"});
  command.run = [request](const Palette& palette) { return run_solve(*request, palette); };
  return command;
}

}  // namespace poise::app
