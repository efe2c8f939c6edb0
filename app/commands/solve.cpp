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
#include "app/commands/solve.hpp"
#include "app/draw/equilibrium_figure.hpp"
#include "app/results/predictions.hpp"

namespace poise::app {
namespace {

struct SolveRequest {
  Request common;
  std::string method = "virtual-work", seek = "settle";
  std::optional<double> proof_seconds;
  LagrangianWords lagrangian;
  std::optional<double> time;
  std::vector<std::string> show;
};

/// Intervals of what is shown of an equilibrium, and of the quantities asked for. Returns whether all have one.
bool add_solve_predictions(Result& result, const FittedNumbers& fit, const StaticModel& model,
                           const Equilibrium& equilibrium, const std::vector<SoughtQuantity>& show) {
  std::vector<SoughtQuantity> of = show;
  for (SoughtQuantity& one : predicted_by_default(model.scene())) {
    const bool is_shown = std::any_of(of.begin(), of.end(), [&](const auto& other) { return other.name == one.name; });
    if (!is_shown) of.push_back(std::move(one));
  }
  return add_predictions(result, fit, predict(fit, model, equilibrium, of), model.scene().units);
}

int run_solve(const SolveRequest& words, const Palette& palette) {
  const Request& request = words.common;
  SolveOptions options;
  options.method = read_method("--method", words.method);
  options.seek = read_seek(words.seek);
  options.certificate = read_proof(words.proof_seconds);
  options.lagrangian = read_lagrangian(words.lagrangian, {options.method});

  Progress progress(words.common.listener());
  progress.now("reading the scene");
  Scene scene = load_moving_scene(request);
  const StaticModel model(words.time ? scene_at_time(std::move(scene), *words.time) : at_time(std::move(scene), 0.0));
  const std::vector<SoughtQuantity> show = read_shown_in_position(words.show, model.scene());
  OutputFiles files(request);
  options.interrupt = &words.common.interrupt();
  const Answer answer = search(model, options, progress);

  SolveOutcome found = outcome_of(model, answer, request.settings, show, files.wants_svg(), files.wants_html());
  if (const std::optional<FittedNumbers> fit = load_fit(request, model.scene()); fit && found.is_solved) {
    progress.now("carrying the errors of the fit into the results");
    found.is_solved = add_solve_predictions(found.result, *fit, model, answer.equilibrium, show) && found.is_solved;
  }
  const bool interrupted = answer.equilibrium.status == Status::interrupted;
  return finish(request, found.result, interrupted ? nullptr : &files, found.pictures, found.is_solved, progress,
                palette);
}

}  // namespace

Scene scene_at_time(Scene scene, double time) {
  expect_number("--time", time, true, "a time, s");
  const bool has_loads = std::any_of(scene.time_functions.begin(), scene.time_functions.end(),
                                     [](const auto& one) { return one.of != TimeFunction::Of::drive; });
  if (!has_loads) {
    throw InputError(
        "--time: no load or spring of the scene follows a function of time; expected one with the key time, or no "
        "--time");
  }
  return at_time(std::move(scene), time);
}

SolveOutcome outcome_of(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings,
                        const std::vector<SoughtQuantity>& show, bool wants_svg, bool wants_figures) {
  std::optional<HeldPose> as_drawn;
  if (has_friction(model.scene()) && model.scene().blades.empty()) as_drawn = held_pose(model, assemble(model));
  const Equilibrium& equilibrium = answer.equilibrium;
  SolveOutcome out{solve_result(model, answer, settings, as_drawn ? &*as_drawn : nullptr, show), {}, false};
  out.is_solved = equilibrium.found() || equilibrium.status == Status::checked;
  const bool drawn = answer.readings && equilibrium.status != Status::interrupted;
  if (wants_svg && drawn) out.pictures.svg = picture(model, answer, show);
  if (wants_figures && drawn) out.pictures.figures = {equilibrium_figure(model, equilibrium, assemble(model))};
  return out;
}

Command solve_command() {
  const auto request = std::make_shared<SolveRequest>();
  Command command{"solve", "Find an equilibrium and the forces in it, by one method"};
  add_scene_options(command, request->common);
  add_with_option(command, request->common);
  add_seek_option(command, request->seek);
  command.add({"--method", &request->method, "METHOD", "One of these, the first by default\n" + method_help()})
      .choices = method_names();
  command.add({"--time", &request->time, "S", "Time at which loads that follow functions of time are taken (0)"});
  add_show_option(command, request->show);
  add_lagrangian_options(command, request->lagrangian);
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism in equilibrium, with loads and joint forces, into\nFILE"});
  command.run = [request](const Palette& palette) { return run_solve(*request, palette); };
  return command;
}

}  // namespace poise::app
