#include "app/results/identification/identify.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/identification/charts.hpp"
#include "app/results/identification/compare_models.hpp"
#include "app/results/identification/fitted_scene.hpp"
#include "app/results/identification/read_fit.hpp"
#include "identification/assessment/check_spans.hpp"
#include "model/named_files.hpp"
#include "model/text_file.hpp"

namespace poise::app {
namespace {

struct IdentifyRequest {
  ExperimentRequest experiment;
  std::vector<std::string> files;
  std::string start = "auto";
  std::string continued;
  std::vector<std::string> profiles;
  int bootstrap = 0;
  bool quick = false;
  bool thorough = false;
  int jobs = 0;
  bool accept_misfit = false;
};

/// Throws InputError for a name that no unknown has.
void expect_unknowns(const FitProblem& problem, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    try {
      parameters_named(problem, name);
    } catch (const InputError& error) {
      throw InputError(std::string("--profile ") + error.what());
    }
  }
}

Checks checks_of(const IdentifyRequest& request) {
  if (request.quick && request.thorough) {
    throw InputError("--quick, --thorough: expected one of them at most, found both; leave one out");
  }
  return request.quick ? Checks::none : request.thorough ? Checks::all : Checks::bounded;
}

int run_identify(const IdentifyRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  FitOptions options;
  options.use_starts = chosen("--start", request.start, start_words()) == 1;
  options.jobs = read_jobs(request.jobs);
  expect_number("--bootstrap", request.bootstrap,
                request.bootstrap == 0 || request.bootstrap >= Bootstrap::least_samples,
                "0 (none), or at least 20 samples");
  options.checks = checks_of(request);
  // From here on an interrupt leaves a result.
  options.interrupt = &request.experiment.common.interrupt();
  if (!common.svg.empty()) expect_plotter();
  Progress progress(request.experiment.common.listener());
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  if (!common.written_scene.empty() && !experiment.parts.empty()) {
    throw InputError("--scene: expected an experiment with one scene, " + experiment.file +
                     " joins several; leave it out");
  }
  if (!common.written_scene.empty())
    expect_beside_files(read_text_file(experiment.scene.file), experiment.scene.file, common.written_scene);
  expect_no_markers(experiment);
  const FitProblem problem(experiment);
  check_spans(problem);
  std::vector<std::string> read = files_read(experiment);
  Fit before;
  if (!request.continued.empty()) {
    before = read_reached(request.continued, problem);
    options.continued = &before;
    read.push_back(request.continued);
  }
  OutputFiles files(common, read);
  options.progress = [&](const std::string& doing) { progress.now(doing); };

  expect_unknowns(problem, request.profiles);
  const Identification answer =
      identify(problem, {.fit = options, .profiles = request.profiles, .bootstrap = request.bootstrap});

  const bool drawn = (files.wants_svg() || files.wants_html()) && !answer.fit.runs.empty();
  Result result = identify_result(problem, answer, common.settings);
  if (drawn) {
    for (const std::string& line : not_drawn(problem, answer)) result.content.note("picture: " + line);
  }
  if (files.wants_csv()) add_readings(result, problem, answer);
  FittedScene scene;
  if (!common.written_scene.empty()) scene = fitted_scene(problem, answer);
  for (const std::string& line : scene.left) result.content.note("scene: " + line);
  Pictures pictures;
  if (files.wants_svg() && drawn) pictures.svg = draw_plot(fit_panels(problem, answer), fit_columns(experiment));
  if (files.wants_html()) {
    pictures.figures = fit_figures(problem, answer);
    std::vector<Figure> estimates = estimate_figures(problem, answer.fit);
    // What is known comes behind the first run, with the mechanism, on which it rests.
    pictures.figures.insert(pictures.figures.begin() + std::min<std::ptrdiff_t>(1, std::ssize(pictures.figures)),
                            std::make_move_iterator(estimates.begin()), std::make_move_iterator(estimates.end()));
  }
  const bool is_whole = !answer.bootstrap || !answer.bootstrap->interrupted;
  const bool is_taken = answer.is_believable() || (request.accept_misfit && answer.fit.usable());
  return finish(common, result, &files, pictures, is_taken && is_whole, progress, palette, scene.text);
}

/// Several models of the same readings.
int run_comparison(const IdentifyRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  if (!request.profiles.empty() || request.bootstrap > 0 || !common.svg.empty() || !common.csv.empty() ||
      !common.written_scene.empty() || !request.continued.empty()) {
    throw InputError(
        "several experiments: expected no --continue, --profile, --bootstrap, --svg, --csv or --scene, which are of "
        "one fit");
  }
  for (std::size_t i = 1; i < request.files.size(); ++i) {
    const auto same = [&](const std::string& other) { return same_file(other, request.files[i]); };
    if (std::any_of(request.files.begin(), request.files.begin() + static_cast<std::ptrdiff_t>(i), same)) {
      throw InputError(request.files[i] + ": expected different experiments to compare, found this one twice");
    }
  }
  CompareOptions options;
  options.fit.use_starts = chosen("--start", request.start, start_words()) == 1;
  options.fit.jobs = read_jobs(request.jobs);
  options.fit.checks = checks_of(request);
  Progress progress(request.experiment.common.listener());
  progress.now("reading the experiments");
  std::deque<Experiment> experiments;
  std::deque<FitProblem> problems;
  std::vector<Experiment*> models;
  std::vector<const FitProblem*> all;
  std::vector<std::string> read;
  for (const std::string& file : request.files) {
    ExperimentRequest one = request.experiment;
    one.common.scene = file;
    experiments.push_back(load_experiment(one));
    models.push_back(&experiments.back());
    for (const std::string& name : files_read(experiments.back())) read.push_back(name);
  }
  leave_out_alike(models);
  for (const Experiment& experiment : experiments) {
    expect_no_markers(experiment);
    problems.emplace_back(experiment);
    check_spans(problems.back());
    all.push_back(&problems.back());
  }
  OutputFiles files(common, read);
  options.fit.interrupt = &request.experiment.common.interrupt();
  options.fit.progress = [&](const std::string& doing) { progress.now(doing); };
  const ModelComparison answer = compare_models(all, options);
  const bool usable = !answer.interrupted && std::all_of(answer.models.begin(), answer.models.end(),
                                                         [](const ModelFit& model) { return model.fit.usable(); });
  return finish(common, compare_models_result(all, answer), &files, {}, usable, progress, palette);
}

}  // namespace

Command identify_command() {
  const auto request = std::make_shared<IdentifyRequest>();
  Command command{"identify", "Estimate masses, inertias, stiffnesses and damping from measured motions"};
  add_experiment_options(command, request->experiment, &request->files);
  command
      .add({"--start", &request->start, "WHAT",
            "auto: from damped sines where the records are such oscillations,\nelse from the experiment's starts "
            "(the default); given: from those\nalways"})
      .choices = start_words();
  command
      .add({"--continue", &request->continued, "FILE",
            "Go on from what an interrupted fit had reached: its --json FILE"})
      .reads("json");
  command.add(
      {"--quick", &request->quick, "",
       "Leave out what puts the minimum in question: the cost away from\nit, other minima, fits without a run"});
  command.add({"--thorough", &request->thorough, "",
               "Put the minimum in question however long that takes, not only\nfor a fifth of the work of the fit"});
  command.add(
      {"--bootstrap", &request->bootstrap, "N",
       "Refit N records resampled from blocks of the residuals, for standard\nerrors that assume no model of them"});
  command.add({"--profile", &request->profiles, "NAME",
               "Find the profile likelihood of an unknown, and its 95 % interval;\ncan be given several times"});
  command.add({"--accept-misfit", &request->accept_misfit, "",
               "Exit with 0 although residuals are above 3 times the noise, or\nrecords have faults that are named"});
  command
      .add({"--scene", &request->experiment.common.written_scene, "FILE",
            "Write the scene with the estimates in place to FILE"})
      .writes("toml");
  add_jobs_option(command, request->jobs,
                  "Threads for the motions of the runs and for profiles (0,\nthe default: all cores)");
  add_output_options(command, request->experiment.common,
                     {.svg = "Draw the worst runs' readings, residuals and sensitivities into\nFILE",
                      .csv = "Write readings, predictions and residuals to FILE, one line\nfor each run and time"});
  command.run = [request](const Palette& palette) {
    request->experiment.common.scene = request->files.front();
    return request->files.size() > 1 ? run_comparison(*request, palette) : run_identify(*request, palette);
  };
  return command;
}

}  // namespace poise::app
