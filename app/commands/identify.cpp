#include "app/results/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
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
#include "app/terminal/interrupt.hpp"
#include "identification/check_spans.hpp"
#include "identification/first_readings.hpp"
#include "identification/residuals.hpp"
#include "model/nearest_name.hpp"

namespace poise::app {
namespace {

struct IdentifyRequest {
  ExperimentRequest experiment;
  std::vector<std::string> files;
  std::string start = "auto";
  std::vector<std::string> profiles;
  int bootstrap = 0;
  int jobs = 0;
};

/// The parameters of these names, or all values of the unknowns of these names. Throws InputError for another name.
std::vector<int> parameters_named(const FitProblem& problem, const std::vector<std::string>& names) {
  std::vector<int> out;
  for (const std::string& name : names) {
    bool any = false;
    std::vector<std::string> valid;
    for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
      valid.push_back(problem.parameters()[p].name);
      if (problem.parameters()[p].name != name && problem.unknown_of(p).name != name) continue;
      out.push_back(static_cast<int>(p));
      any = true;
    }
    if (!any) {
      throw InputError("--profile " + name + ": expected the name of an unknown" + did_you_mean_or_list(name, valid));
    }
  }
  return out;
}

int run_identify(const IdentifyRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  FitOptions options;
  options.use_starts = chosen("--start", request.start, {"auto", "given"}) == 1;
  options.jobs = read_jobs(request.jobs);
  expect_number("--bootstrap", request.bootstrap, request.bootstrap == 0 || request.bootstrap >= 20,
                "0 (none), or at least 20 samples");
  if (!common.svg.empty()) expect_plotter();
  Progress progress;
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  if (!common.written_scene.empty() && !experiment.parts.empty()) {
    throw InputError("--scene: expected an experiment with one scene, " + experiment.file +
                     " joins several; leave it out");
  }
  const FitProblem problem(experiment);
  check_spans(problem);
  OutputFiles files(common, files_read(experiment));
  options.interrupt = &watch_for_interrupt();
  options.progress = [&](const std::string& doing) { progress.now(doing); };

  const std::vector<int> profiled = parameters_named(problem, request.profiles);
  FitAnswer answer;
  progress.now("simulating the runs");
  answer.records = problem.records();
  progress.now("fitting");
  answer.fit = fit(problem, answer.records, options);
  if (answer.fit.usable() && !experiment.is_simulated()) {
    progress.now("moving the runs from their first readings");
    answer.rms_from_readings = rms_from_first_readings(problem, answer.fit, answer.records);
  }
  if (answer.fit.usable()) answer.stops = stops_passed(problem, answer.fit);
  if (answer.fit.usable() && answer.fit.identifiability.ok) {
    progress.now("propagating the uncertainty of known numbers and inputs");
    answer.inputs = input_effects(problem, answer.fit, answer.records);
    if (!experiment.known.empty()) answer.known = known_effects(problem, answer.fit, answer.records);
    add_known_effects(answer.known, answer.fit);
    add_known_effects(answer.inputs, answer.fit);
  }
  std::vector<int> known;
  std::copy_if(profiled.begin(), profiled.end(), std::back_inserter(known), [&](int p) {
    const auto& errors = answer.fit.identifiability.standard_error;
    return answer.fit.usable() && !errors.empty() && std::isfinite(errors[static_cast<std::size_t>(p)]);
  });
  answer.profiles = profiles(problem, answer.records, answer.fit, known,
                             {.jobs = options.jobs, .interrupt = options.interrupt, .progress = options.progress});

  if (request.bootstrap > 0 && answer.fit.usable()) {
    answer.bootstrap = bootstrap(
        problem, answer.records, answer.fit,
        {.samples = request.bootstrap, .jobs = request.jobs, .interrupt = options.interrupt, .progress = [&](int done) {
           progress.now(fmt::format("bootstrap: {} of {} samples", done, request.bootstrap));
         }});
  }

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
    pictures.figures = estimate_figures(problem, answer.fit);
    for (Figure& figure : fit_figures(problem, answer)) pictures.figures.push_back(std::move(figure));
  }
  return finish(common, result, &files, pictures, answer.fit.usable(), progress, palette, scene.text);
}

/// Several models of the same readings.
int run_comparison(const IdentifyRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  if (!request.profiles.empty() || request.bootstrap > 0 || !common.svg.empty() || !common.csv.empty() ||
      !common.written_scene.empty()) {
    throw InputError(
        "several experiments: expected no --profile, --bootstrap, --svg, --csv or --scene, which are of one fit");
  }
  for (std::size_t i = 1; i < request.files.size(); ++i) {
    const auto same = [&](const std::string& other) { return same_file(other, request.files[i]); };
    if (std::any_of(request.files.begin(), request.files.begin() + static_cast<std::ptrdiff_t>(i), same)) {
      throw InputError(request.files[i] + ": expected different experiments to compare, found this one twice");
    }
  }
  CompareOptions options;
  options.fit.use_starts = chosen("--start", request.start, {"auto", "given"}) == 1;
  options.fit.jobs = read_jobs(request.jobs);
  Progress progress;
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
    problems.emplace_back(experiment);
    check_spans(problems.back());
    all.push_back(&problems.back());
  }
  OutputFiles files(common, read);
  options.fit.interrupt = &watch_for_interrupt();
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
  command.add({"--start", &request->start, "WHAT",
               "auto: from damped sines where the records are such oscillations,\nelse from the experiment's starts "
               "(the default); given: from those\nalways"});
  command.add(
      {"--bootstrap", &request->bootstrap, "N",
       "Refit N records resampled from blocks of the residuals, for standard\nerrors that assume no model of them"});
  command.add({"--profile", &request->profiles, "NAME",
               "Find the profile likelihood of an unknown, and its 95 % interval;\ncan be given several times"});
  command.add({"--scene", &request->experiment.common.written_scene, "FILE",
               "Write the scene with the estimates in place to FILE"});
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
