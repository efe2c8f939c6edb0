#include "app/commands/identifiability.hpp"

#include <memory>

#include "app/commands/experiment_options.hpp"
#include "app/commands/session.hpp"
#include "app/report/identifiability_report.hpp"
#include "identification/first_readings.hpp"

namespace poise::app {
namespace {

struct IdentifiabilityRequest {
  ExperimentRequest experiment;
  bool base = false;
};

int run_identifiability(const IdentifiabilityRequest& request, const Palette& palette) {
  const Request& common = request.experiment.common;
  Progress progress;
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  const FitProblem problem(experiment);
  OutputFiles files(common, files_read(experiment));

  progress.now("looking at what the runs tell");
  std::vector<std::vector<double>> nuisances;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    nuisances.push_back(first_guess(problem.run(r), experiment.records[r]));
  }
  IdentifiabilityAnswer answer;
  answer.known = assess(problem, problem.truths(), nuisances);
  progress.now("looking for base parameters");
  answer.base = base_parameters(problem.run(0).scene());
  answer.list_base = request.base;
  const std::string written =
      files.write(files.wants_json() ? identifiability_json(problem, answer, common.settings) : "", "");
  progress.done();
  print(identifiability_report(problem, answer, palette) + (written.empty() ? "" : "\n" + written));
  return answer.known.ok ? solved : not_solved;
}

}  // namespace

Command identifiability_command() {
  const auto request = std::make_shared<IdentifiabilityRequest>();
  Command command{"identifiability", "Find which parameters are identifiable by an experiment, before any data"};
  add_experiment_options(command, request->experiment);
  command.add({"--base", &request->base, "", "List the base parameters of the mechanism, too"});
  command.run = [request](const Palette& palette) { return run_identifiability(*request, palette); };
  return command;
}

}  // namespace poise::app
