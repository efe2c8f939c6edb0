#include "app/results/identification/identifiability.hpp"

#include <memory>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "identification/assessment/check_spans.hpp"
#include "identification/fit/first_readings.hpp"

namespace poise::app {
namespace {

struct IdentifiabilityRequest {
  ExperimentRequest experiment;
  bool base = false;
};

int run_identifiability(const IdentifiabilityRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  Progress progress(request.experiment.common.listener());
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  const FitProblem problem(experiment);
  check_spans(problem);
  OutputFiles files(common, files_read(experiment));

  progress.now("computing the sensitivities of the runs");
  std::vector<std::vector<double>> nuisances;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    nuisances.push_back(first_guess(problem.run(r), problem.unknowns_of(r, problem.truths()), experiment.records[r]));
  }
  const Identifiability known = assess(problem, problem.truths(), nuisances);
  progress.now("computing base parameters");
  const BaseParameters base = base_parameters(problem.run(0).scene());
  const Result result = identifiability_result(problem, known, base, request.base, common.settings);
  Pictures pictures;
  if (files.wants_html()) {
    pictures.figures = chart_figures("What the readings determine", identifiability_panels(problem, known));
  }
  return finish(common, result, &files, pictures, known.ok, progress, palette);
}

}  // namespace

Command identifiability_command() {
  const auto request = std::make_shared<IdentifiabilityRequest>();
  Command command{"identifiability", "Find which parameters an experiment determines, before any fit"};
  add_experiment_options(command, request->experiment);
  command.add({"--base", &request->base, "", "List the base parameters of the mechanism, too"});
  add_output_options(command, request->experiment.common, {});
  command.run = [request](const Palette& palette) { return run_identifiability(*request, palette); };
  return command;
}

}  // namespace poise::app
