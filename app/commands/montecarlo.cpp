#include <cstdint>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/identification/monte_carlo.hpp"
#include "app/terminal/interrupt.hpp"

namespace poise::app {
namespace {

struct MonteCarloRequest {
  ExperimentRequest experiment;
  int trials = 300;
  std::uint64_t seed = 1;
  double start_error = 0.5;
  int jobs = 0;
  std::string start = "given";
};

void check(const MonteCarloRequest& request) {
  expect_between("--trials", request.trials, 1, 1'000'000);
  expect_number("--jobs", request.jobs, request.jobs >= 0 && request.jobs <= 1024,
                "a number from 0 (all cores) to 1024");
  expect_number("--start-error", request.start_error, request.start_error >= 0 && request.start_error < 1,
                "a part of the truth, 0 <= start error < 1");
}

int run_montecarlo(const MonteCarloRequest& request, const Palette& palette) {
  check(request);
  MonteCarloOptions options;
  options.trials = request.trials;
  options.seed = request.seed;
  options.start_error = request.start_error;
  options.threads = request.jobs;
  options.use_starts = chosen("--start", request.start, {"given", "auto"}) == 0;
  const Request& common = request.experiment.common;
  Progress progress;
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  const FitProblem problem(experiment);
  OutputFiles files(common, files_read(experiment));
  options.interrupt = &watch_for_interrupt();
  const auto report = [&](int done) { progress.now(fmt::format("{} of {} trials", done, options.trials)); };
  report(0);
  options.progress = report;
  const MonteCarlo answer = monte_carlo(problem, options);
  const Result result = monte_carlo_result(problem, options, answer, common.settings);
  return finish(common, result, &files, "", !answer.interrupted && answer.converged > 0, progress, palette);
}

}  // namespace

Command montecarlo_command() {
  const auto request = std::make_shared<MonteCarloRequest>();
  Command command{"montecarlo", "Simulate and fit many times, to verify the standard errors of the estimates"};
  add_experiment_options(command, request->experiment);
  command.add({"--trials", &request->trials, "N", "Simulations to fit (300)"});
  command.add({"--seed", &request->seed, "N", "Seed of the noise and of the starts (1)"});
  command.add(
      {"--start-error", &request->start_error, "PART",
       "Every fit starts from parameters that differ from the truth by\nup to this part of it, drawn at random (0.5)"});
  command.add({"--start", &request->start, "WHAT",
               "given: from those (the default); auto: from damped sines\nwhere the records oscillate so"});
  command.add({"--jobs", &request->jobs, "N", "Threads (all cores)"});
  add_output_options(command, request->experiment.common, {});
  command.run = [request](const Palette& palette) { return run_montecarlo(*request, palette); };
  return command;
}

}  // namespace poise::app
