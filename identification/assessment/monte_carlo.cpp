#include "identification/assessment/monte_carlo.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "solvers/random_stream.hpp"

namespace poise {
namespace {

constexpr double nominal_coverage = 0.95;
/// Its two-sided quantile of the normal distribution.
constexpr double normal_quantile_95 = 1.959963984540054;

/// Random numbers of a trial: those of its starts, and behind them those of the noise of each run.
constexpr std::uint32_t stream_of_starts = 0, stream_of_first_run = 1;

/// The numbers of a trial that come before value and standard error of each parameter.
enum Column : std::size_t { has_converged, residual_over_noise, evaluations, first_estimate };

std::vector<std::string> column_names(const MonteCarlo& answer) {
  std::vector<std::string> names = {"converged", "residual_over_noise", "evaluations"};
  for (const auto* all : {&answer.parameters, &answer.combinations}) {
    for (const TrialStatistics& one : *all) {
      names.push_back(one.name);
      names.push_back(one.name + " standard error");
    }
  }
  return names;
}

std::vector<double> run_trial(const FitProblem& problem, const std::vector<Record>& ideal,
                              const std::vector<Identifiability::Combination>& combined,
                              const MonteCarloOptions& options, std::uint64_t trial) {
  std::vector<Record> records = ideal;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const auto stream = static_cast<std::uint32_t>(stream_of_first_run + r);
    problem.add_noise(records[r], solvers::RandomStream(options.seed, stream, trial));
  }
  solvers::RandomStream random(options.seed, stream_of_starts, trial);
  FitOptions fit_options;
  fit_options.use_starts = options.use_starts;
  fit_options.interrupt = options.study.interrupt;
  fit_options.jobs = 1;
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    const double error = random.uniform(-options.start_error, options.start_error);
    const double shown = std::abs(p.truth + problem.unknown_of(i).includes);
    const double start = p.truth + error * (shown != 0 ? shown : problem.scale_of(i).size);
    fit_options.starts.push_back(std::clamp(start, p.min, p.max));
  }
  const Fit fitted = fit(problem, records, fit_options);
  std::vector<double> row(first_estimate + 2 * (problem.parameters().size() + combined.size()), NAN);
  row[has_converged] = fitted.status == FitStatus::converged ? 1 : 0;
  row[residual_over_noise] = fitted.residual_over_noise;
  row[evaluations] = fitted.evaluations;
  for (std::size_t i = 0; i < fitted.estimates.size(); ++i) {
    row[first_estimate + 2 * i] = fitted.estimates[i].value;
    row[first_estimate + 2 * i + 1] = fitted.estimates[i].standard_error;
  }
  if (!fitted.identifiability.ok) return row;
  std::vector<double> shown;
  for (const Estimate& estimate : fitted.estimates) shown.push_back(estimate.value);
  for (std::size_t k = 0; k < combined.size(); ++k) {
    const std::size_t at = first_estimate + 2 * (problem.parameters().size() + k);
    row[at] = combined[k].at(shown);
    row[at + 1] = fitted.errors.of(combined[k].gradient(shown));
  }
  return row;
}

/// Adds a trial to the sums of which summarise() makes means.
void add_trial(const double* row, MonteCarlo& sums) {
  ++sums.trials;
  sums.evaluations += row[evaluations];
  if (row[has_converged] == 0) return;
  ++sums.converged;
  sums.residual_over_noise += row[residual_over_noise];
  bool near = true;
  const double* estimate = row + first_estimate;
  for (auto* all : {&sums.parameters, &sums.combinations}) {
    for (TrialStatistics& s : *all) {
      const double error = estimate[0] - s.truth;
      s.bias += error;
      s.rmse += error * error;
      s.coverage += std::abs(error) <= normal_quantile_95 * estimate[1] ? 1.0 : 0.0;
      near = near && std::abs(error) <= 6 * s.bound;
      estimate += 2;
    }
  }
  sums.near_truth += near ? 1 : 0;
}

void summarise(MonteCarlo& sums) {
  const double converged = std::max(1, sums.converged);
  for (auto* all : {&sums.parameters, &sums.combinations}) {
    for (TrialStatistics& s : *all) {
      s.bias /= converged;
      s.rmse = std::sqrt(s.rmse / converged);
      s.coverage /= converged;
    }
  }
  sums.residual_over_noise /= converged;
  sums.evaluations /= std::max(1, sums.trials);
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
      throw InputError(fmt::format(
          "{}:{}: run \"{}\": expected simulated runs only, this one is measured; give it {} "
          "in place of {}",
          problem.experiment().file, run.line, run.name, run.is_at_rest() ? "inputs as lists" : "a duration and a rate",
          run.is_at_rest() ? "readings" : "data"));
    }
    ideal.push_back(problem.ideal_record(r));
    nuisances.push_back(problem.run(r).released());
  }
  const Identifiability bound = assess(problem, problem.truths(), nuisances);
  const auto begun = std::chrono::steady_clock::now();
  MonteCarlo out;
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
  for (const Identifiability::Combination& one : bound.combinations) {
    const double divisor = one.over < 0 ? 1.0 : problem.unknown_of(static_cast<std::size_t>(one.over)).unit;
    TrialStatistics s;
    s.name = one.words;
    s.truth = one.value;
    s.unit = problem.unknown_of(static_cast<std::size_t>(one.unit_of)).unit / divisor;
    s.bound = one.standard_error;
    out.combined.push_back(one);
    out.combinations.push_back(s);
  }
  studies::Study study;
  study.name = "montecarlo";
  study.identity = options.identity;
  study.identity.insert(study.identity.end(), {{"trials", std::to_string(options.trials)},
                                               {"seed", std::to_string(options.seed)},
                                               {"start", options.use_starts ? "given" : "auto"},
                                               {"start error", fmt::format("{}", options.start_error)}});
  study.columns = column_names(out);
  study.samples = static_cast<std::uint64_t>(std::max(0, options.trials));
  study.compute = [&](std::uint64_t trial) { return run_trial(problem, ideal, out.combined, options, trial); };
  const studies::StudyOutcome outcome =
      studies::run_study(study, options.study, [&](std::uint64_t, const double* row) { add_trial(row, out); });
  summarise(out);
  out.asked = static_cast<int>(outcome.asked);
  out.computed = static_cast<int>(outcome.computed);
  out.interrupted = outcome.interrupted;
  out.warnings = outcome.warnings;
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  return out;
}

}  // namespace poise
