#include "app/report/monte_carlo_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/identifiability_json.hpp"
#include "app/json_parts.hpp"
#include "app/report/experiment_parts.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

std::string verdict(const MonteCarloOptions& options, const MonteCarlo& answer, const Palette& palette) {
  if (answer.trials == 0) return palette.paint(Tone::bad, "Interrupted before the first trial had ended.");
  const std::string done = answer.interrupted
                               ? fmt::format("Interrupted after {} of {} trials", answer.trials, options.trials)
                               : fmt::format("{} simulated and fitted", count(answer.trials, "trial", "trials"));
  if (answer.converged == 0) return palette.paint(Tone::bad, done + ": no fit converged.");
  std::string deviates;
  for (const TrialStatistics& s : answer.parameters) {
    const bool fits = s.is_identifiable() && against_bound(s, answer.converged).as_expected();
    if (!fits) deviates += (deviates.empty() ? "" : ", ") + s.name;
  }
  const Tone good = answer.interrupted ? Tone::doubtful : Tone::good;
  if (answer.converged < answer.trials) {
    return palette.paint(Tone::bad, fmt::format("{}: {} did not converge.", done,
                                                count(answer.trials - answer.converged, "fit", "fits")));
  }
  if (!deviates.empty()) return palette.paint(Tone::doubtful, done + "; not as sure as it says: " + deviates + ".");
  return palette.paint(good, done + ": estimates are as sure as they say.");
}

std::string facts(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                  const Palette& palette) {
  std::string out = fact("data", what_is_read(problem), palette) + fact("asked", what_is_asked(problem), palette);
  out += fact("start",
              options.use_starts ? fmt::format("up to {} % from the truth", significant(100 * options.start_error, 3))
                                 : "found by the fits themselves",
              palette);
  out += fact("fits",
              fmt::format("{} of {} converged, {} of them within 6 deviations of the truth", answer.converged,
                          answer.trials, answer.near_truth),
              palette);
  if (answer.converged > 0)
    out += fact("residuals", fmt::format("{} times the noise on average", significant(answer.residual_over_noise, 4)),
                palette);
  return out + fact("effort",
                    fmt::format("{}; {} evaluations a fit, {} a trial", duration(1e6 * answer.seconds),
                                significant(answer.evaluations, 3),
                                duration(1e6 * answer.seconds / std::max(1, answer.trials))),
                    palette);
}

}  // namespace

std::string monte_carlo_report(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                               const Palette& palette) {
  std::string out = heading(problem.experiment(), palette) + verdict(options, answer, palette) + "\n" +
                    facts(problem, options, answer, palette);
  if (answer.converged == 0) return out;
  std::vector<std::string> names, truths, bounds;
  std::vector<std::vector<Cell>> columns(3);
  for (const TrialStatistics& s : answer.parameters) {
    names.push_back(s.name);
    truths.push_back(significant(s.truth / s.unit, 6));
    bounds.push_back(s.is_identifiable() ? per_cent(s.bound, s.truth) : "not told");
    const BoundStatistics all = against_bound(s, answer.converged);
    const auto add = [&](std::size_t column, const Statistic& statistic, std::string text) {
      if (!s.is_identifiable()) text = "-";
      columns[column].push_back({text, statistic.as_expected() || !s.is_identifiable() ? Tone::plain : Tone::bad});
    };
    add(0, all.bias, fmt::format("{:+.3f} ± {:.3f}", all.bias.value, all.bias.standard_error));
    add(1, all.rmse, fmt::format("{:.3f} ± {:.3f}", all.rmse.value, all.rmse.standard_error));
    add(2, all.coverage, fmt::format("{:.1f} ± {:.1f} %", 100 * all.coverage.value, 100 * all.coverage.standard_error));
  }
  Table table;
  table.add_text_column("parameter", names);
  table.add_number_column("truth", truths);
  table.add_text_column("unit", parameter_units(problem));
  table.add_number_column("bound, per cent", bounds);
  table.add_text_column("bias/bound", columns[0]);
  table.add_text_column("rms error/bound", columns[1]);
  table.add_text_column("95 % intervals that cover", columns[2]);
  return out + section("Estimates against the Cramer-Rao bound", table.print(palette), palette);
}

std::string monte_carlo_json(const FitProblem& problem, const MonteCarloOptions& options, const MonteCarlo& answer,
                             const std::vector<std::string>& settings) {
  Json out = json_experiment(problem, settings);
  out["trials_asked"] = options.trials;
  out["trials"] = answer.trials;
  out["converged"] = answer.converged;
  out["arrived"] = answer.near_truth;
  out["interrupted"] = answer.interrupted;
  out["seed"] = options.seed;
  out["off"] = options.use_starts ? Json(options.start_error) : Json(nullptr);
  out["misfit"] = json_number(answer.residual_over_noise);
  out["evaluations"] = json_number(answer.evaluations);
  out["seconds"] = json_number(answer.seconds);
  const std::vector<std::string> units = parameter_units(problem);
  out["estimates"] = Json::array();
  for (std::size_t i = 0; answer.converged > 0 && i < answer.parameters.size(); ++i) {
    const TrialStatistics& s = answer.parameters[i];
    const BoundStatistics all = against_bound(s, answer.converged);
    out["estimates"].push_back({{"name", s.name},
                                {"unit", units[i]},
                                {"truth", json_number(s.truth / s.unit)},
                                {"bound", s.is_identifiable() ? json_number(s.bound / s.unit) : Json(nullptr)},
                                {"bias", json_number(s.bias / s.unit)},
                                {"rmse", json_number(s.rmse / s.unit)},
                                {"rmse_over_bound", s.is_identifiable() ? json_number(all.rmse.value) : Json(nullptr)},
                                {"coverage", json_number(s.coverage)},
                                {"coverage_deviation", json_number(all.coverage.standard_error)}});
  }
  return json_text(out, problem.experiment().scene);
}

}  // namespace poise::app
