#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/commands/commands.hpp"
#include "app/commands/options.hpp"
#include "app/commands/session.hpp"
#include "app/results/identification/monte_carlo.hpp"
#include "app/terminal/mpi_ranks.hpp"
#include "studies/fingerprint.hpp"

namespace poise::app {
namespace {

struct MonteCarloRequest {
  ExperimentRequest experiment;
  int trials = 300;
  std::uint64_t seed = 1;
  double start_error = 0.5;
  int jobs = 0;
  std::string start = "given";
  std::string output, shard;
  bool resume = false;
};

void check(const MonteCarloRequest& request) {
  expect_between("--trials", request.trials, 1, 1'000'000);
  expect_number("--start-error", request.start_error, request.start_error >= 0 && request.start_error < 1,
                "a part of the truth, 0 <= start error < 1");
  if (!request.output.empty()) return;
  if (request.resume) throw InputError("--resume: expected --output DIR beside it, the folder to go on with");
  if (!request.shard.empty()) throw InputError("--shard: expected --output DIR beside it, where the shards meet");
}

/// "2/3": the second of three.
void read_shard(const std::string& text, studies::StudyOptions& options) {
  const std::size_t slash = std::min(text.find('/'), text.size());
  const char* const end = text.data() + text.size();
  const auto part = std::from_chars(text.data(), text.data() + slash, options.shard);
  const auto whole = std::from_chars(std::min(text.data() + slash + 1, end), end, options.shards);
  const bool is_read =
      part.ec == std::errc() && whole.ec == std::errc() && part.ptr == text.data() + slash && whole.ptr == end;
  if (is_read && options.shard >= 1 && options.shard <= options.shards && options.shards <= 1'000'000) return;
  throw InputError(fmt::format("--shard: expected i/N, the part i = 1 .. N of N, found \"{}\"", text));
}

MonteCarloOptions read_options(const MonteCarloRequest& request) {
  MonteCarloOptions options;
  options.trials = request.trials;
  options.seed = request.seed;
  options.start_error = request.start_error;
  options.use_starts = chosen("--start", request.start, start_words()) == 1;
  options.study.jobs = read_jobs(request.jobs);
  options.study.folder = request.output;
  options.study.resume = request.resume;
  if (!request.shard.empty()) read_shard(request.shard, options.study);
  return options;
}

int run_montecarlo(const MonteCarloRequest& request, const Palette& palette) {
  check(request);
  MonteCarloOptions options = read_options(request);
  const Request& common = request.experiment.common;
  // A program that calls has ranks of its own, if any.
  const std::unique_ptr<studies::Ranks> ranks = common.caller != nullptr ? nullptr : join_ranks(options.study.jobs);
  options.study.ranks = ranks.get();
  const bool is_first = ranks == nullptr || ranks->rank() == 0;
  Progress progress(request.experiment.common.listener());
  progress.now("reading the experiment");
  const Experiment experiment = load_experiment(request.experiment);
  const FitProblem problem(experiment);
  const std::vector<std::string> read = files_read(experiment);
  std::optional<OutputFiles> files;
  if (is_first) files.emplace(common, read);
  std::vector<std::filesystem::path> inputs(read.begin(), read.end());
  inputs.emplace_back(common.scene);
  options.identity = {{"version", POISE_VERSION}, {"experiment", studies::fingerprint(inputs, common.settings)}};
  options.study.interrupt = &request.experiment.common.interrupt();
  const auto report = [&](std::uint64_t done) { progress.now(fmt::format("{} of {} trials", done, options.trials)); };
  report(0);
  options.study.progress = report;
  const MonteCarlo answer = monte_carlo(problem, options);
  if (!is_first) return solved;
  const Result result = monte_carlo_result(problem, options, answer, common.settings);
  const bool is_solved = !answer.interrupted && (answer.converged > 0 || answer.asked == 0);
  Pictures pictures;
  if (files->wants_html()) pictures.figures = chart_figures("Errors of the estimates", monte_carlo_panels(answer));
  return finish(common, result, &*files, pictures, is_solved, progress, palette);
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
  command
      .add({"--start", &request->start, "WHAT",
            "given: from those (the default); auto: from damped sines\nwhere the records oscillate so"})
      .choices = start_words();
  add_jobs_option(command, request->jobs, "Threads, of each rank under mpirun (0, the default: all\ncores)");
  command.add({"--output", &request->output, "DIR", "Keep every trial in files of this new folder (docs/studies.md)"})
      .writes("/");
  command.add({"--resume", &request->resume, "", "Go on with what --output DIR has"}).use = Use::output;
  command
      .add({"--shard", &request->shard, "i/N",
            "Only part i = 1 .. N of the trials, into --output DIR: for job\narrays; --resume without it then "
            "completes and merges all parts"})
      .use = Use::output;
  add_output_options(command, request->experiment.common, {});
  command.run = [request](const Palette& palette) { return run_montecarlo(*request, palette); };
  return command;
}

}  // namespace poise::app
