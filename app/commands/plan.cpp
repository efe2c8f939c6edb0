#include "app/results/identification/plan.hpp"

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "identification/assessment/check_spans.hpp"

namespace poise::app {
namespace {

struct PlanRequest {
  ExperimentRequest experiment;
  std::uint64_t seed = 1;
  int jobs = 0;
  std::string prediction, scene;
};

int run_plan(const PlanRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  PlanOptions options;
  options.seed = request.seed;
  options.jobs = read_jobs(request.jobs);
  Progress progress(request.experiment.common.listener());
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  if (!experiment.plan) {
    throw InputError(experiment.file + ": plan: expected what may be chosen; add [plan] (docs/planning.md)");
  }
  const FitProblem problem(experiment);
  check_spans(problem);
  if (request.prediction.empty() && !request.scene.empty()) {
    throw InputError("--in: expected --for beside it, the result of that scene that is to be sharp");
  }
  if (!request.prediction.empty()) {
    progress.now("differentiating " + request.prediction);
    options.prediction =
        planned_prediction(problem, request.scene.empty() ? experiment.scene : at_time(read_scene(request.scene), 0.0),
                           request.prediction);
  }
  const ExperimentText text(experiment, {request.experiment.data, common.settings});
  std::vector<std::string> read = files_read(experiment);
  if (!request.scene.empty()) read.push_back(request.scene);
  OutputFiles files(common, read);
  options.interrupt = &request.experiment.common.interrupt();
  options.progress = [&](const std::string& what) { progress.now_and_then([&] { return what; }); };
  const auto begin = std::chrono::steady_clock::now();
  const Plan plan = plan_runs(problem, text, options);
  const double microseconds =
      std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();

  progress.now("writing the result");
  const Result result = plan_result(problem, text, options, plan, microseconds, common.settings);
  std::string planned;
  if (!plan.runs.empty()) {
    planned = fmt::format("# Runs that poise plan --seed {} has chosen within the limits of {}.\n", options.seed,
                          std::filesystem::path(experiment.file).filename().string()) +
              text.with(plan.runs, true, std::filesystem::path(common.experiment).parent_path());
  }
  Pictures pictures;
  if (files.wants_html()) pictures.figures = chart_figures("What more runs bring", plan_panels(problem, plan));
  const std::string written = files.write(result, pictures, planned);
  progress.done();
  print(common, result, written, palette);
  const bool is_sharp = !options.prediction || (!plan.steps.empty() && std::isfinite(plan.steps.back().prediction));
  return !plan.runs.empty() && !plan.interrupted && plan.steps.back().ok && is_sharp ? solved : not_solved;
}

}  // namespace

Command plan_command() {
  const auto request = std::make_shared<PlanRequest>();
  Command command{"plan", "Choose the runs of an experiment that determine its parameters best"};
  add_experiment_options(command, request->experiment);
  command.add({"--seed", &request->seed, "N", "Of the runs that are tried (1)"});
  command.add({"--for", &request->prediction, "QUANTITY",
               "Make the standard error of this result smallest: fold.load.P, force.S,\n... (docs/quantities.md), in "
               "place of the criterion of [plan]"});
  command.add({"--in", &request->scene, "FILE", "The scene that --for is a result of; else that of the experiment"})
      .reads("toml");
  add_jobs_option(command, request->jobs, "Threads (0, the default: all cores)");
  command
      .add({"--experiment", &request->experiment.common.experiment, "FILE",
            "Write the experiment with the planned runs to FILE"})
      .writes("toml");
  add_output_options(command, request->experiment.common, {});
  command.run = [request](const Palette& palette) { return run_plan(*request, palette); };
  return command;
}

}  // namespace poise::app
