#include "app/results/statics/compare.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/draw/equilibrium_figure.hpp"
#include "app/results/statics/work_precision.hpp"

namespace poise::app {
namespace {

/// The answer to draw: the first confirmed one, or else the first that reached any pose.
const Answer* best_of(const std::vector<Answer>& answers) {
  const Answer* best = nullptr;
  for (const Answer& answer : answers) {
    if (!answer.readings) continue;
    if (answer.equilibrium.found()) return &answer;
    if (best == nullptr) best = &answer;
  }
  return best;
}

struct CompareRequest {
  Request common;
  std::string seek;  // empty: not given
  std::optional<std::string> methods, tolerances;
  std::optional<int> repeat;
  std::optional<double> proof_seconds;
  LagrangianWords lagrangian;
};

comparison::WorkPrecisionOptions work_precision_options(const CompareRequest& words) {
  if (words.proof_seconds) throw InputError("--proof-seconds: does not count with --tolerances; leave one of them out");
  comparison::WorkPrecisionOptions options;
  options.methods = read_methods("--methods", words.methods.value_or("all"));
  options.lagrangian = read_lagrangian(words.lagrangian, options.methods);
  options.tolerances = read_tolerances(*words.tolerances);
  options.repeats = words.repeat.value_or(options.repeats);
  if (!words.seek.empty()) options.seek = read_seek(words.seek);
  if (options.seek == Seek::settle) {
    throw InputError(
        "--seek settle: does not go with --tolerances, which measures searches from the start; expected any or stable");
  }
  expect_between("--repeat", options.repeats, 1, 10'000);
  return options;
}

/// Of the default methods each has to find an equilibrium where it applies; of a list given by --methods, one of them.
bool succeeded(const CompareRequest& words, const std::vector<Answer>& answers) {
  const auto is_solved = [](const Answer& a) {
    return a.equilibrium.found() || a.equilibrium.status == Status::checked;
  };
  const auto is_interrupted = [](const Answer& a) { return a.equilibrium.status == Status::interrupted; };
  if (words.methods) {
    return std::any_of(answers.begin(), answers.end(), is_solved) &&
           std::none_of(answers.begin(), answers.end(), is_interrupted);
  }
  return std::all_of(answers.begin(), answers.end(),
                     [&](const Answer& a) { return is_solved(a) || a.equilibrium.status == Status::not_applicable; });
}

int run_side_by_side(const CompareRequest& words, const Palette& palette) {
  const Request& request = words.common;
  if (words.repeat) throw InputError("--repeat: counts only with --tolerances; leave it out or give both");
  if (!request.csv.empty()) throw InputError("--csv: is written only with --tolerances; leave it out or give both");
  SolveOptions options;
  if (!words.seek.empty()) options.seek = read_seek(words.seek);
  options.certificate = read_proof(words.proof_seconds);
  const std::vector<Method> methods = read_methods("--methods", words.methods.value_or("virtual-work,energy"));
  options.lagrangian = read_lagrangian(words.lagrangian, methods);

  Progress progress(words.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  OutputFiles files(request);
  options.interrupt = &words.common.interrupt();
  std::vector<Answer> answers;
  for (const Method method : methods) {
    options.method = method;
    answers.push_back(search(model, options, progress));
    if (answers.back().equilibrium.status == Status::interrupted) break;
  }

  const Result result = compare_result(model, answers, request.settings);
  const bool interrupted = answers.back().equilibrium.status == Status::interrupted;
  const Answer* drawn = interrupted ? nullptr : best_of(answers);
  Pictures pictures;
  if (files.wants_svg() && drawn != nullptr) pictures.svg = picture(model, *drawn);
  if (files.wants_html() && drawn != nullptr) {
    pictures.figures = {equilibrium_figure(model, drawn->equilibrium, assemble(model))};
  }
  return finish(request, result, interrupted ? nullptr : &files, pictures, succeeded(words, answers), progress,
                palette);
}

int run_work_precision(const CompareRequest& words, const Palette& palette) {
  const Request& request = words.common;
  comparison::WorkPrecisionOptions options = work_precision_options(words);
  Progress progress(words.common.listener());
  progress.now("reading the scene");
  const StaticModel model(load_scene(request));
  OutputFiles files(request);
  if (files.wants_svg()) expect_plotter();
  options.interrupt = &words.common.interrupt();
  options.progress = [&progress](const std::string& doing) { progress.now(doing); };
  const comparison::WorkPrecision study = comparison::work_precision(model, options);

  const Result result = work_precision_result(model, study, options.repeats, request.settings);
  Pictures pictures;
  if (files.wants_svg() && !study.interrupted) pictures.svg = draw_plot(work_precision_panels(model, study));
  if (files.wants_html()) {
    pictures.figures = chart_figures("Error against time", work_precision_panels(model, study));
  }
  return finish(request, result, study.interrupted ? nullptr : &files, pictures,
                comparison::any_confirmed(study) && !study.interrupted, progress, palette);
}

}  // namespace

Command compare_command() {
  const auto request = std::make_shared<CompareRequest>();
  Command command{"compare", "Find an equilibrium by several methods side by side"};
  add_scene_options(command, request->common);
  add_seek_option(command, request->seek);
  command
      .add({"--methods", &request->methods, "NAMES",
            "virtual-work,energy (the default), any other list of names, or\nall (the default with "
            "--tolerances). With a list it is enough\nfor exit code 0 that one is confirmed.\n" +
                method_help()})
      .choices = method_list_words();
  add_lagrangian_options(command, request->lagrangian);
  add_proof_option(command, request->proof_seconds);
  command.add({"--tolerances", &request->tolerances, "RANGE",
               "Speed against error: runs at these tolerances, by decades\n(1e-2..1e-14) or as a list (1e-3,1e-6); "
               "--svg then draws the\nerror against the time; exit code 0 where some run is confirmed"});
  command.add({"--repeat", &request->repeat, "N", "Runs of each to take the median time of (7)"});
  add_output_options(command, request->common,
                     {.svg = "Draw the mechanism in equilibrium, or, with --tolerances, error\nagainst time, into FILE",
                      .csv = "Write the runs at all tolerances to FILE as CSV"});
  command.run = [request](const Palette& palette) {
    return request->tolerances ? run_work_precision(*request, palette) : run_side_by_side(*request, palette);
  };
  return command;
}

}  // namespace poise::app
