#include "app/results/identification/monte_carlo.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/identification/experiment.hpp"

namespace poise::app {
namespace {

Line verdict(const MonteCarloOptions& options, const MonteCarlo& answer) {
  if (answer.trials == 0) return {.text = "Interrupted before the first trial had ended.", .tone = Tone::bad};
  const std::string done = answer.interrupted
                               ? fmt::format("Interrupted after {} of {} trials", answer.trials, options.trials)
                               : fmt::format("{} simulated and fitted", count(answer.trials, "trial", "trials"));
  if (answer.converged == 0) return {.text = done + ": no fit converged.", .tone = Tone::bad};
  if (answer.converged < answer.trials) {
    return {
        .text = fmt::format("{}: {} did not converge.", done, count(answer.trials - answer.converged, "fit", "fits")),
        .tone = Tone::bad};
  }
  std::vector<std::string> differing;
  for (const TrialStatistics& s : answer.parameters) {
    const bool agrees = s.is_identifiable() && against_bound(s, answer.converged).as_expected();
    if (!agrees) differing.push_back(s.name);
  }
  if (!differing.empty()) {
    return {.text = fmt::format("{}: the errors do not agree with the stated standard errors of {}.", done,
                                listed(differing)),
            .tone = Tone::doubtful};
  }
  return {.text = done + ": the errors agree with the stated standard errors.",
          .tone = answer.interrupted ? Tone::doubtful : Tone::good};
}

void add_estimates(Group& group, const FitProblem& problem, const MonteCarlo& answer) {
  struct Cells {
    std::vector<std::string> texts;
    std::vector<Tone> tones;
  };
  std::vector<std::string> names, units, truth_texts, bound_texts;
  std::vector<double> truths, bounds, biases, errors, relative_errors, coverages, coverage_errors;
  Cells bias, rmse, coverage;
  const std::vector<std::string> all_units = parameter_units(problem);
  for (std::size_t i = 0; answer.converged > 0 && i < answer.parameters.size(); ++i) {
    const TrialStatistics& s = answer.parameters[i];
    const BoundStatistics found = against_bound(s, answer.converged);
    const bool known = s.is_identifiable();
    names.push_back(s.name);
    units.push_back(all_units[i]);
    truths.push_back(s.truth / s.unit);
    truth_texts.push_back(significant(truths.back(), 6));
    bounds.push_back(known ? s.bound / s.unit : NAN);
    bound_texts.push_back(known ? per_cent(s.bound, s.truth) : "not identifiable");
    biases.push_back(s.bias / s.unit);
    errors.push_back(s.rmse / s.unit);
    relative_errors.push_back(known ? found.rmse.value : NAN);
    coverages.push_back(s.coverage);
    coverage_errors.push_back(found.coverage.standard_error);
    const auto add = [&](Cells& cells, const Statistic& statistic, std::string text) {
      cells.texts.push_back(known ? std::move(text) : "-");
      cells.tones.push_back(statistic.as_expected() || !known ? Tone::plain : Tone::bad);
    };
    add(bias, found.bias, fmt::format("{:+.3f} ± {:.3f}", found.bias.value, found.bias.standard_error));
    add(rmse, found.rmse, fmt::format("{:.3f} ± {:.3f}", found.rmse.value, found.rmse.standard_error));
    add(coverage, found.coverage,
        fmt::format("{:.1f} ± {:.1f} %", 100 * found.coverage.value, 100 * found.coverage.standard_error));
  }
  Table& table = group.table("estimates", "Errors of the estimates over the Cramer-Rao bound", Rows::list);
  table.words("name", "parameter", std::move(names));
  table.numbers("truth", "truth", "", std::move(truths)).texts = std::move(truth_texts);
  table.words("unit", "unit", std::move(units));
  table.numbers("bound", "bound, per cent", "", std::move(bounds)).texts = std::move(bound_texts);
  const auto add_words = [&](const std::string& title, Cells cells) {
    table.words("", title, std::move(cells.texts)).tones = std::move(cells.tones);
  };
  add_words("bias / bound", std::move(bias));
  add_words("rms error / bound", std::move(rmse));
  add_words("95 % intervals that cover", std::move(coverage));
  table.data("bias", std::move(biases));
  table.data("rmse", std::move(errors));
  table.data("rmse_over_bound", std::move(relative_errors));
  table.data("coverage", std::move(coverages));
  table.data("coverage_standard_error", std::move(coverage_errors));
  table.footnotes = {"expected: bias 0, rms error 1, coverage 95 %"};
}

}  // namespace

Result monte_carlo_result(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                          const std::vector<std::string>& settings) {
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(options, answer);
  Group& content = out.content;
  add_estimates(content, problem, answer);
  content.data("trials_requested", options.trials);
  content.data("trials", answer.trials);
  content.data("converged", answer.converged);
  content.data("near_truth", answer.near_truth);
  content.data("interrupted", answer.interrupted);
  content.data("seed", options.seed);
  content.data("start_error", options.use_starts ? Value(options.start_error) : Value());
  content.data("residual_over_noise", answer.residual_over_noise);
  content.data("evaluations", answer.evaluations);
  content.data("seconds", answer.seconds);
  Group& numerics = content.group("", "Numerics");
  numerics.fact("data", data_in_words(problem));
  numerics.fact("start", options.use_starts ? fmt::format("within {} % of the true parameters, at random",
                                                          significant(100 * options.start_error, 3))
                                            : "found by the fits themselves");
  std::string fits = fmt::format("{} of {} converged, {} of them within 6 standard errors of the truth",
                                 answer.converged, answer.trials, answer.near_truth);
  if (answer.converged > 0) {
    fits += fmt::format("; residuals {} times the noise on average", significant(answer.residual_over_noise, 4));
  }
  numerics.fact("fits", fits);
  numerics.fact("effort", fmt::format("{}; {} evaluations a fit, {} a trial", duration(1e6 * answer.seconds),
                                      significant(answer.evaluations, 3),
                                      duration(1e6 * answer.seconds / std::max(1, answer.trials))));
  return out;
}

}  // namespace poise::app
