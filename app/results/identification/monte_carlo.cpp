#include "app/results/identification/monte_carlo.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/draw/chart/interval_chart.hpp"
#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"

namespace poise::app {
namespace {

bool is_shard(const MonteCarloOptions& options) { return options.study.shards > 1; }

std::string shard_in_words(const MonteCarloOptions& options) {
  return fmt::format("{}/{}", options.study.shard, options.study.shards);
}

Line verdict(const MonteCarloOptions& options, const MonteCarlo& answer) {
  if (answer.asked == 0) {
    return doubtful(fmt::format("No trials for shard {}: there are only {}.", shard_in_words(options), options.trials));
  }
  const std::string part = is_shard(options) ? " of shard " + shard_in_words(options) : "";
  if (answer.trials == 0) return bad("Interrupted before the first trial had ended.");
  const std::string done =
      answer.interrupted ? fmt::format("Interrupted after {} of {} trials{}", answer.trials, answer.asked, part)
                         : fmt::format("{}{} simulated and fitted", count(answer.trials, "trial", "trials"), part);
  if (answer.converged == 0) return bad(done + ": no fit converged.");
  if (answer.converged < answer.trials) {
    return {
        .text = fmt::format("{}: {} did not converge.", done, count(answer.trials - answer.converged, "fit", "fits")),
        .tone = Tone::bad};
  }
  std::vector<std::string> differing;
  for (const auto* all : {&answer.parameters, &answer.combinations}) {
    for (const TrialStatistics& s : *all) {
      // What is not identifiable has no standard error that its errors could disagree with.
      if (s.is_identifiable() && !against_bound(s, answer.converged).as_expected()) differing.push_back(s.name);
    }
  }
  if (!differing.empty()) {
    return doubtful(
        fmt::format("{}: the errors do not agree with the stated standard errors of {}.", done, listed(differing)));
  }
  return {.text = done + ": the errors agree with the stated standard errors.",
          .tone = answer.interrupted ? Tone::doubtful : Tone::good};
}

/// `what`: "parameter" or "combination".
void add_errors(Group& group, const std::string& key, const std::string& heading, const std::string& what,
                const std::vector<TrialStatistics>& all, const std::vector<std::string>& units, int converged) {
  struct Row {
    TrialStatistics of;
    BoundStatistics found;
    std::string unit;
  };
  std::vector<Row> rows;
  for (std::size_t i = 0; converged > 0 && i < all.size(); ++i) {
    rows.push_back({all[i], against_bound(all[i], converged), units[i]});
  }
  const auto si = [&](double TrialStatistics::*value) {
    return each(rows, [&](const Row& row) { return row.of.*value / row.of.unit; });
  };
  const auto if_known = [](const Row& row, double value) { return row.of.is_identifiable() ? value : NAN; };
  Table& table = group.table(key, heading, Rows::list);
  table.words("name", what, each(rows, [](const Row& row) { return row.of.name; }));
  table.numbers("truth", "truth", "", si(&TrialStatistics::truth)).texts =
      each(rows, [](const Row& row) { return significant(row.of.truth / row.of.unit, 6); });
  table.words("unit", "unit", each(rows, &Row::unit));
  table
      .numbers("bound", "bound, per cent", "",
               each(rows, [&](const Row& row) { return if_known(row, row.of.bound / row.of.unit); }))
      .texts = each(rows, [](const Row& row) {
    if (!row.of.is_identifiable()) return std::string("not identifiable");
    return row.of.truth != 0 ? per_cent(row.of.bound, row.of.truth)
                             : significant(row.of.bound / row.of.unit, 2) + " " + row.unit;
  });
  const auto add = [&](const std::string& title, Statistic BoundStatistics::*statistic, auto&& text) {
    table
        .words("", title,
               each(rows, [&](const Row& row) { return row.of.is_identifiable() ? text(row.found.*statistic) : "-"; }))
        .tones = each(rows, [&](const Row& row) {
      return (row.found.*statistic).as_expected() || !row.of.is_identifiable() ? Tone::plain : Tone::bad;
    });
  };
  add("bias / bound", &BoundStatistics::bias,
      [](const Statistic& s) { return fmt::format("{:+.3f} ± {:.3f}", s.value, s.standard_error); });
  add("rms error / bound", &BoundStatistics::rmse,
      [](const Statistic& s) { return fmt::format("{:.3f} ± {:.3f}", s.value, s.standard_error); });
  add("95 % intervals that cover", &BoundStatistics::coverage,
      [](const Statistic& s) { return fmt::format("{:.1f} ± {:.1f} %", 100 * s.value, 100 * s.standard_error); });
  table.data("bias", si(&TrialStatistics::bias));
  table.data("rmse", si(&TrialStatistics::rmse));
  table.data("rmse_over_bound", each(rows, [&](const Row& row) { return if_known(row, row.found.rmse.value); }));
  table.data("coverage", each(rows, [](const Row& row) { return row.of.coverage; }));
  table.data("coverage_standard_error", each(rows, [](const Row& row) { return row.found.coverage.standard_error; }));
  table.footnotes = {"expected: bias 0, rms error 1, coverage 95 %"};
}

}  // namespace

Result monte_carlo_result(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                          const std::vector<std::string>& settings) {
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(options, answer);
  Group& content = out.content;
  add_errors(content, "estimates", "Errors of the estimates over the Cramer-Rao bound", "parameter", answer.parameters,
             parameter_units(problem), answer.converged);
  if (!answer.combinations.empty()) {
    add_errors(content, "combinations", "Errors of the combinations that are identifiable", "combination",
               answer.combinations, combination_units(problem, answer.combined), answer.converged);
  }
  content.data("trials_requested", options.trials);
  content.data("shard", is_shard(options) ? Value(shard_in_words(options)) : Value());
  content.data("trials", answer.trials);
  content.data("converged", answer.converged);
  content.data("near_truth", answer.near_truth);
  content.data("interrupted", answer.interrupted);
  content.data("seed", options.seed);
  content.data("start_error", options.use_starts ? Value(options.start_error) : Value());
  content.data("residual_over_noise", answer.residual_over_noise);
  content.data("evaluations", answer.evaluations);
  content.data("seconds", answer.seconds);
  for (const std::string& warning : answer.warnings) out.warnings.push_back(doubtful(warning + "."));
  if (answer.interrupted && !options.study.folder.empty()) {
    out.warnings.push_back(doubtful(
        fmt::format("The complete chunks are in {}: the same command with --resume goes on.", options.study.folder)));
  }
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("data", data_in_words(problem));
  numerics.fact("start", options.use_starts ? fmt::format("within {} % of the true parameters, at random",
                                                          significant(100 * options.start_error, 3))
                                            : "found by the fits themselves");
  std::string fits = fmt::format("{} of {} converged, {} of them within 6 standard errors of the truth",
                                 answer.converged, answer.trials, answer.near_truth);
  if (answer.converged > 0) {
    fits += fmt::format("; residuals {} times the noise on average", significant(answer.residual_over_noise, 4));
  }
  if (answer.computed < answer.trials) {
    fits += fmt::format("; {} computed now, the others read from {}", answer.computed, options.study.folder);
  }
  numerics.fact("fits", fits);
  numerics.fact("effort", fmt::format("{}; {} evaluations a fit, {} a trial", duration(1e6 * answer.seconds),
                                      significant(answer.evaluations, 3),
                                      duration(1e6 * answer.seconds / std::max(1, answer.computed))));
  return out;
}

std::vector<Panel> monte_carlo_panels(const MonteCarlo& answer) {
  struct Shown {
    const char* title;
    Statistic BoundStatistics::*statistic;
    double expected;
  };
  constexpr Shown shown[] = {{"mean error over the bound", &BoundStatistics::bias, 0.0},
                             {"rms error over the bound", &BoundStatistics::rmse, 1.0},
                             {"part of the 95 % intervals that cover the truth", &BoundStatistics::coverage, 0.95}};
  std::vector<TrialStatistics> all = answer.parameters;
  all.insert(all.end(), answer.combinations.begin(), answer.combinations.end());
  if (answer.converged == 0 ||
      std::none_of(all.begin(), all.end(), [](const auto& s) { return s.is_identifiable(); })) {
    return {};
  }
  std::vector<Panel> panels;
  for (const Shown& one : shown) {
    std::vector<Interval> intervals;
    for (const TrialStatistics& parameter : all) {
      const Statistic found = against_bound(parameter, answer.converged).*one.statistic;
      const double value = parameter.is_identifiable() ? found.value : NAN;
      intervals.push_back({parameter.name, value - 2 * found.standard_error, value, value + 2 * found.standard_error});
    }
    panels.push_back({.title = one.title,
                      .y_label = "value ± 2 standard errors",
                      .curves = interval_curves(intervals),
                      .levels = {{one.expected, "expected"}}});
  }
  panels.back().x_label = "parameter, by its number";
  return panels;
}

}  // namespace poise::app
