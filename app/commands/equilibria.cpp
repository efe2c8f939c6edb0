#include "app/results/statics/equilibria.hpp"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/equilibria_picture.hpp"
#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/predictions.hpp"
#include "statics/model/mobility.hpp"

namespace poise::app {
namespace {

struct EquilibriaRequest {
  Request common;
  std::vector<std::string> drives;
  bool assemblies = false;
  std::vector<std::string> show;
  std::optional<double> seconds;
  int starts = AllEquilibriaOptions{}.starts;
  std::uint64_t seed = 1;
  int jobs = 0;
  std::optional<double> proof_seconds;
};

/// Holds a measure at a value, SI, or where the mechanism stands at its start.
void hold_at(Scene& scene, const std::string& name, const Measure& on, const std::optional<double>& value) {
  Stop& motor = scene.stops.emplace_back();
  motor.name = name;
  motor.on = on;
  if (value) {
    motor.min = motor.max = *value;
    return;
  }
  const StaticModel model(scene);
  scene.stops.back().min = scene.stops.back().max = read_off(model, close_loops(model)).stops.back();
}

/// A scene with drives held by its last stops, so many.
struct HeldScene {
  Scene scene;
  std::size_t drives = 0;
};

/// The scene with its drives held: those of the command line, or, for assemblies, its own.
HeldScene held_scene(const EquilibriaRequest& request) {
  Scene scene = load_scene(request.common);
  const std::size_t stops = scene.stops.size();
  const std::vector<Drive> own = scene.drives;
  std::set<std::string> held;
  for (const std::string& text : request.drives) {
    const std::string name = text.substr(0, text.find('='));
    if (!held.insert(name).second) throw InputError(fmt::format("--drive {}: expected once, found twice", name));
    if (text.find('=') == std::string::npos) {
      hold_at(scene, text, find_drive(scene, text).on, {});
      continue;
    }
    const DriveRange range = read_drive(text, scene, "NAME=VALUE, say crank=30");
    if (range.from != range.to) {
      throw InputError(
          fmt::format("--drive {}: expected one place, NAME=VALUE; a range has no equilibria of its own, see "
                      "poise path",
                      text));
    }
    hold_at(scene, range.name, find_drive(scene, range.name).on, range.from);
  }
  if (request.assemblies && request.drives.empty()) {
    for (const Drive& drive : own) hold_at(scene, drive.name, drive.on, drive.start);
  }
  const std::size_t held_stops = scene.stops.size() - stops;
  if (!request.assemblies) return {std::move(scene), held_stops};
  // Outputs may be of what is left out.
  scene.outputs.clear();
  return {positions_alone(std::move(scene)), held_stops};
}

/// The scene by whose names quantities are asked for: what is held is a drive of it, and no stop.
Scene named_scene(Scene scene, std::size_t held) {
  std::vector<Drive> drives;
  for (auto stop = scene.stops.end() - static_cast<std::ptrdiff_t>(held); stop != scene.stops.end(); ++stop) {
    Drive& drive = drives.emplace_back();
    drive.name = stop->name;
    drive.on = stop->on;
  }
  scene.stops.resize(scene.stops.size() - held);
  return naming_drives(std::move(scene), drives);
}

AllEquilibriaOptions read_options(const EquilibriaRequest& request) {
  AllEquilibriaOptions options;
  if (request.seconds) {
    expect_number("--seconds", *request.seconds, *request.seconds >= 0.0, "a time in s, 0 or more");
  }
  expect_between("--starts", request.starts, 0, 100'000'000);
  options.seconds = request.seconds;
  options.starts = request.starts;
  options.seed = request.seed;
  options.jobs = read_jobs(request.jobs);
  options.assemblies = request.assemblies;
  options.certificate = read_proof(request.proof_seconds);
  options.interrupt = &request.common.interrupt();
  return options;
}

/// "1: stable, -131.69 N m; solve settles here".
std::vector<std::string> captions_of(const StaticModel& model, const EquilibriumSet& set, bool assemblies) {
  std::vector<std::string> out;
  for (std::size_t k = 0; k < set.equilibria.size(); ++k) {
    const Equilibrium& equilibrium = set.equilibria[k];
    std::string text = std::to_string(k + 1);
    if (!assemblies) text += ": " + stability_and_energy(model, equilibrium);
    if (static_cast<int>(k) == set.settles_into) text += assemblies ? ": the start" : "; solve settles here";
    out.push_back(std::move(text));
  }
  return out;
}

int run_equilibria(const EquilibriaRequest& request, const Palette& palette) {
  AllEquilibriaOptions options = read_options(request);
  Progress progress(request.common.listener());
  progress.now("reading the scene");
  HeldScene given = held_scene(request);
  const std::size_t held = given.drives;
  const StaticModel model(std::move(given.scene));
  const EquilibriaView view{read_shown_in_position(request.show, named_scene(model.scene(), held)),
                            held == 0 ? -1 : static_cast<int>(model.scene().stops.size() - held)};
  OutputFiles files(request.common);
  options.progress = [&](double decided) {
    progress.now_and_then([&] { return fmt::format("proving: {:.1f} % of the volume decided", 100.0 * decided); });
  };
  options.searched = [&](int done) {
    progress.now_and_then([&] { return fmt::format("searching: start {} of {}", done, options.starts); });
  };
  progress.now("looking for equilibria");
  const EquilibriumSet set = all_equilibria(model, options);
  std::vector<Answer> answers;
  for (const Equilibrium& equilibrium : set.equilibria) {
    progress.now_and_then(
        [&] { return fmt::format("refining {} of {} in 50 digits", answers.size() + 1, set.equilibria.size()); });
    answers.push_back(measure(model, equilibrium));
  }
  Result result = equilibria_result(model, set, answers, options, view, request.common.settings);
  bool all_predicted = true;
  if (const std::optional<FittedNumbers> fit = load_fit(request.common, model.scene())) {
    progress.now("carrying the errors of the fit into the equilibria");
    std::vector<PredictedResult> predictions;
    const std::vector<SoughtQuantity> of = view.show.empty() ? predicted_by_default(model.scene()) : view.show;
    for (std::size_t k = 0; k < set.equilibria.size(); ++k) {
      for (PredictedResult& one : predict(*fit, model, set.equilibria[k], of)) {
        one.name = fmt::format("{} in {}", one.name, k + 1);
        predictions.push_back(std::move(one));
      }
    }
    all_predicted = add_predictions(result, *fit, predictions, model.scene().units);
  }
  if (files.wants_svg() && set.equilibria.empty()) {
    result.warnings.push_back(doubtful("No picture is written: there is nothing to draw."));
  }
  const bool complete = set.claim == Claim::complete;
  Pictures pictures;
  if (files.wants_svg() && !set.equilibria.empty()) {
    progress.now("drawing");
    pictures.svg =
        equilibria_picture(model, set, captions_of(model, set, request.assemblies), result.verdict.text, complete);
  }
  if (files.wants_html() && !set.equilibria.empty()) {
    pictures.figures = {equilibria_figure(model, set, captions_of(model, set, request.assemblies))};
  }
  const bool as_asked = complete || (options.seconds == 0.0 && !set.equilibria.empty());
  return finish(request.common, result, &files, pictures, as_asked && !set.interrupted && all_predicted, progress,
                palette);
}

}  // namespace

Command equilibria_command() {
  const auto request = std::make_shared<EquilibriaRequest>();
  Command command{"equilibria", "Find all equilibria, and say whether they are proved to be all"};
  add_scene_options(command, request->common);
  add_with_option(command, request->common);
  command.add({"--assemblies", &request->assemblies, "",
               "Positions alone: all ways in which the loops close, with the drives\nheld; nothing else may move"});
  command.add({"--drive", &request->drives, "NAME[=VALUE]",
               "crank=30: hold the angle of a body in the world, the travel of a joint\nor a measure "
               "(length.SPRING=200) there; crank: where it stands; several\ntimes"});
  command.add({"--seconds", &request->seconds, "S",
               "Time for the proof that there are no others (a number of boxes, about\na minute); 0: no proof, random "
               "starts alone"});
  command.add({"--starts", &request->starts, "N", "Random starts, where nothing is proved (1000)"});
  command.add({"--seed", &request->seed, "N", "Of the random starts (1)"});
  add_show_option(command, request->show);
  add_jobs_option(command, request->jobs, "Threads (0, the default: all cores); the result is the same");
  add_proof_option(command, request->proof_seconds);
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism in all of them, side by side, into FILE",
                      .csv = "Write the table of equilibria to FILE"});
  command.run = [request](const Palette& palette) { return run_equilibria(*request, palette); };
  return command;
}

}  // namespace poise::app
