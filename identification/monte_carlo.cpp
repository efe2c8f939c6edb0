#include "identification/monte_carlo.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

#include <fmt/format.h>

namespace poise {
namespace {

constexpr double nominal_coverage = 0.95;
/// Its two-sided quantile of the normal distribution.
constexpr double quantile = 1.959963984540054;

struct Trial {
  bool converged = false;
  std::vector<double> value, standard_error;
  double residual_over_noise = 0.0;
  int evaluations = 0;
};

Trial run_trial(const FitProblem& problem, const std::vector<Record>& ideal, const MonteCarloOptions& options,
                int trial) {
  std::vector<Record> records = ideal;
  const std::uint64_t seed = options.seed * 1'000'003 + static_cast<std::uint64_t>(trial);
  for (std::size_t r = 0; r < records.size(); ++r) problem.add_noise(records[r], seed * 1'009 + r);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> error(-options.start_error, options.start_error);
  FitOptions fit_options;
  fit_options.use_starts = options.use_starts;
  fit_options.interrupt = options.interrupt;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    const double start = p.truth + error(random) * std::abs(p.truth + problem.unknown_of(i).includes);
    fit_options.starts.push_back(std::clamp(start, p.min, p.max));
  }
  const Fit fitted = fit(problem, records, fit_options);
  Trial out;
  out.converged = fitted.status == FitStatus::converged;
  out.residual_over_noise = fitted.residual_over_noise;
  out.evaluations = fitted.evaluations;
  for (const Estimate& estimate : fitted.estimates) {
    out.value.push_back(estimate.value);
    out.standard_error.push_back(estimate.standard_error);
  }
  return out;
}

}  // namespace

bool TrialStatistics::is_identifiable() const { return std::isfinite(bound) && bound > 0; }

bool Statistic::as_expected() const {
  constexpr double by_chance = 4.0;
  return std::abs(value - expected) <= by_chance * standard_error;
}

BoundStatistics against_bound(const TrialStatistics& parameter, int trials) {
  const double n = std::max(1, trials);
  return {{parameter.bias / parameter.bound, 1 / std::sqrt(n), 0.0},
          {parameter.rmse / parameter.bound, 1 / std::sqrt(2 * n), 1.0},
          {parameter.coverage, std::sqrt(nominal_coverage * (1 - nominal_coverage) / n), nominal_coverage}};
}

MonteCarlo monte_carlo(const FitProblem& problem, const MonteCarloOptions& options) {
  std::vector<Record> ideal;
  std::vector<std::vector<double>> nuisances;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const Run& run = problem.run(r).run();
    if (!run.is_simulated()) {
      throw InputError(
          fmt::format("{}:{}: run \"{}\": expected simulated runs only, this one is measured; give it a "
                      "duration and a rate in place of data",
                      problem.experiment().file, run.line, run.name));
    }
    ideal.push_back(problem.ideal_record(r));
    nuisances.push_back(problem.run(r).released());
  }
  const Identifiability bound = assess(problem, problem.truths(), nuisances);
  const auto begun = std::chrono::steady_clock::now();
  std::vector<Trial> trials(static_cast<std::size_t>(std::max(0, options.trials)));
  std::vector<char> done(trials.size(), 0);
  std::atomic<int> next{0};
  std::mutex reporting;
  int finished = 0;
  const auto stopped = [&] { return options.interrupt != nullptr && options.interrupt->load(); };
  const auto work = [&] {
    for (int i = next++; i < options.trials && !stopped(); i = next++) {
      trials[static_cast<std::size_t>(i)] = run_trial(problem, ideal, options, i);
      if (stopped()) return;
      done[static_cast<std::size_t>(i)] = 1;
      const std::scoped_lock lock(reporting);
      ++finished;
      if (options.progress) options.progress(finished);
    }
  };
  const int threads =
      options.threads > 0 ? options.threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  {
    std::vector<std::jthread> workers;
    for (int t = 1; t < threads; ++t) workers.emplace_back(work);
    work();
  }
  MonteCarlo out;
  out.interrupted = stopped();
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    const Unknown& unknown = problem.unknown_of(i);
    TrialStatistics s;
    s.name = p.name;
    s.truth = p.truth + unknown.includes;
    s.unit = unknown.unit;
    s.bound = bound.ok ? bound.standard_error[i] : 0.0;
    out.parameters.push_back(s);
  }
  for (std::size_t t = 0; t < trials.size(); ++t) {
    if (done[t] == 0) continue;
    const Trial& trial = trials[t];
    ++out.trials;
    out.evaluations += trial.evaluations;
    if (!trial.converged) continue;
    ++out.converged;
    out.residual_over_noise += trial.residual_over_noise;
    bool near = true;
    for (std::size_t i = 0; i < out.parameters.size(); ++i) {
      TrialStatistics& s = out.parameters[i];
      const double error = trial.value[i] - s.truth;
      s.bias += error;
      s.rmse += error * error;
      s.coverage += std::abs(error) <= quantile * trial.standard_error[i] ? 1.0 : 0.0;
      near = near && std::abs(error) <= 6 * s.bound;
    }
    out.near_truth += near ? 1 : 0;
  }
  const double converged = std::max(1, out.converged);
  for (TrialStatistics& s : out.parameters) {
    s.bias /= converged;
    s.rmse = std::sqrt(s.rmse / converged);
    s.coverage /= converged;
  }
  out.residual_over_noise /= converged;
  out.evaluations /= std::max(1, out.trials);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace poise
