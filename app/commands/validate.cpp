#include "app/results/identification/validate.hpp"

#include <memory>
#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/identification/charts.hpp"
#include "app/results/identification/read_fit.hpp"
#include "identification/assessment/check_spans.hpp"
#include "identification/assessment/record_faults.hpp"
#include "identification/fit/first_readings.hpp"

namespace poise::app {
namespace {

const std::vector<std::string> validation_starts = {"fitted", "measured"};

struct ValidateRequest {
  ExperimentRequest experiment;
  std::string with;
  std::string starts = "fitted";
  int jobs = 0;
};

int run_validate(const ValidateRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  const Starts starts = chosen("--starts", request.starts, validation_starts) == 1 ? Starts::measured : Starts::fitted;
  FitOptions options;
  options.jobs = read_jobs(request.jobs);
  if (!common.svg.empty()) expect_plotter();
  Progress progress(request.experiment.common.listener());
  progress.now("reading the fit and the experiment");
  const FittedModel model = read_fit(request.with);
  Experiment experiment = load_experiment(request.experiment);
  take_noise(model, experiment);
  expect_no_markers(experiment);
  const FitProblem problem(experiment);
  parameters_of(problem, model);
  check_spans(problem);
  std::vector<std::string> read = files_read(experiment);
  read.push_back(request.with);
  OutputFiles files(common, read);
  options.interrupt = &request.experiment.common.interrupt();
  options.progress = [&](const std::string& doing) { progress.now(doing); };

  Identification answer;
  progress.now("simulating the runs");
  answer.records = problem.records();
  progress.now("predicting the runs");
  const Validation validation = validate(problem, answer.records, model, starts, options);
  answer.fit = validation.fit;
  if (answer.fit.usable() && !experiment.is_simulated()) {
    answer.rms_from_readings = rms_from_first_readings(problem, answer.fit, answer.records);
  }
  Result result = validation_result(problem, answer, validation, model, starts, common.settings);
  if (files.wants_csv()) add_readings(result, problem, answer);
  Pictures pictures;
  if (files.wants_svg() && !answer.fit.runs.empty()) {
    pictures.svg = draw_plot(fit_panels(problem, answer), fit_columns(experiment));
  }
  if (files.wants_html()) pictures.figures = fit_figures(problem, answer);
  return finish(common, result, &files, pictures, answer.fit.usable(), progress, palette);
}

}  // namespace

Command validate_command() {
  const auto request = std::make_shared<ValidateRequest>();
  Command command{"validate", "Predict other records with the parameters of a fit, and compare"};
  add_experiment_options(command, request->experiment);
  command
      .add({"--with", &request->with, "FILE",
            "Result of poise identify --json FILE: its estimates are taken as\nthey "
            "are, by the names of the unknowns",
            Presence::required})
      .reads("json");
  command
      .add({"--starts", &request->starts, "WHAT",
            "fitted: start and equilibrium of every run are fitted to its record\n(the default); measured: starts "
            "follow from the first readings"})
      .choices = validation_starts;
  add_jobs_option(command, request->jobs, "Threads for the motions of the runs (0, the default:\nall cores)");
  add_output_options(command, request->experiment.common,
                     {.svg = "Draw the worst runs' readings, residuals and sensitivities into\nFILE",
                      .csv = "Write readings, predictions and residuals to FILE, one line\nfor each run and time"});
  command.run = [request](const Palette& palette) { return run_validate(*request, palette); };
  return command;
}

}  // namespace poise::app
