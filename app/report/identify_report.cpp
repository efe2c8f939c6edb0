#include "app/report/identify_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/report/experiment_parts.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"
#include "identification/residuals.hpp"

namespace poise::app {
namespace {

constexpr int residual_digits = 3;
// An estimate farther than this from the truth of a simulation is marked.
constexpr double remarkable = 4.0;
// Residuals with an autocorrelation a tell about as much as (1 - a)/(1 + a) times as many independent ones: here half.
constexpr double not_independent = 1.0 / 3.0;

int withheld(const Fit& fitted) {
  return static_cast<int>(
      std::count_if(fitted.estimates.begin(), fitted.estimates.end(), [](const Estimate& e) { return e.withheld; }));
}

/// The largest autocorrelation of any sensor in any run.
double most_lagged(const Fit& fitted) {
  double largest = 0.0;
  for (const RunFit& run : fitted.runs) {
    for (const double a : run.autocorrelation) largest = std::max(largest, a);
  }
  return largest;
}

std::string verdict(const Fit& fitted, const Palette& palette) {
  std::string text;
  Tone tone = Tone::good;
  switch (fitted.status) {
    case FitStatus::converged:
      text = "Converged: the residuals are as large as the noise says.";
      break;
    case FitStatus::misfit:
      text = fmt::format("Converged, but take care: {}.", fitted.why);
      tone = Tone::doubtful;
      break;
    case FitStatus::not_run:
    case FitStatus::failed:
    case FitStatus::interrupted:
      return palette.paint(Tone::bad, fmt::format("No fit: {}.", fitted.why)) + "\n";
  }
  std::string out = palette.paint(tone, text) + "\n";
  if (withheld(fitted) > 0) {
    const std::string all = count(static_cast<int>(fitted.estimates.size()), "estimate", "estimates");
    out += palette.paint(Tone::bad, fmt::format("Withheld: {} of {}, see below.", withheld(fitted), all)) + "\n";
  }
  if (most_lagged(fitted) > not_independent) {
    out += palette.paint(Tone::doubtful,
                         fmt::format("Residuals resemble the ones before them (autocorrelation up to {:.3f}): readings "
                                     "say less than as many independent ones, deviations are larger than shown, by "
                                     "rule of thumb {} times.",
                                     most_lagged(fitted), significant(fitted.autocorrelation_factor, 2))) +
           "\n";
  }
  if (!fitted.identifiability.ok) {
    out +=
        palette.paint(Tone::bad, "How sure the estimates are is not known: " + fitted.identifiability.why + ".") + "\n";
  }
  return out;
}

/// "phi1 0.00292 rad, phi2 0.00403 rad; all angles 0.00351 rad".
std::string rms_in_words(const std::vector<double>& rms, const Experiment& experiment) {
  const Units& units = experiment.scene.units;
  std::string text;
  double squares = 0.0;
  int angles = 0;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    text += fmt::format("{}{} {} {}", k > 0 ? ", " : "", sensor.name,
                        significant(rms[k] / sensor.dimension().unit(units), residual_digits),
                        sensor.dimension().unit_name(units));
    if (sensor.reads_force() || !sensor.on.is_angle() || sensor.rate) continue;
    squares += rms[k] * rms[k];
    ++angles;
  }
  if (angles < 2) return text;
  return text + fmt::format("; all angles {} {}",
                            significant(in_unit(std::sqrt(squares / angles), Quantity::angle, units), residual_digits),
                            unit_name(Quantity::angle, units));
}

std::string facts(const FitProblem& problem, const FitAnswer& answer, const Palette& palette) {
  const Fit& fitted = answer.fit;
  std::string out = fact("data", what_is_read(problem), palette) + fact("asked", what_is_asked(problem), palette);
  if (!fitted.start.empty()) out += fact("start", fitted.start, palette);
  if (!fitted.runs.empty()) {
    const auto white = std::count_if(fitted.runs.begin(), fitted.runs.end(), [](const RunFit& r) { return r.white; });
    out += fact(
        "residuals",
        fmt::format("{} times the noise, expected 1 ± {}; white in {} of {}",
                    significant(fitted.residual_over_noise, 4), significant(2 * fitted.residual_over_noise_sigma, 2),
                    white, count(static_cast<int>(fitted.runs.size()), "run", "runs")),
        palette);
    out += fact("rms", rms_in_words(fitted.rms, problem.experiment()), palette);
  }
  if (!answer.rms_from_readings.empty()) {
    out += fact("", rms_in_words(answer.rms_from_readings, problem.experiment()) + ": from the runs' first readings",
                palette);
  }
  return out +
         fact("effort",
              fmt::format("Levenberg-Marquardt from {}: {}, {} of all runs with sensitivities, {}",
                          count(fitted.tries, "start", "starts"), count(fitted.iterations, "iteration", "iterations"),
                          count(fitted.evaluations, "evaluation", "evaluations"), duration(fitted.microseconds)),
              palette);
}

std::string estimate_section(const FitProblem& problem, const Fit& fitted, const Palette& palette) {
  if (fitted.estimates.empty()) return "";
  const bool sure = fitted.identifiability.ok;
  const bool any = withheld(fitted) < static_cast<int>(fitted.estimates.size());
  std::vector<std::string> names, deviations, relative, truths;
  std::vector<Cell> values, off, notes;
  for (const Estimate& e : fitted.estimates) {
    names.push_back(e.name);
    notes.push_back({e.why, Tone::bad});
    if (e.withheld) {
      values.push_back({"withheld", Tone::bad});
      for (auto* column : {&deviations, &relative, &truths}) column->emplace_back();
      off.emplace_back();
      continue;
    }
    const double error = (e.value - e.truth) / e.standard_error;
    values.push_back({with_deviation(e.value / e.unit, sure ? e.standard_error / e.unit : 0.0), Tone::plain});
    deviations.push_back(sure ? significant(e.standard_error / e.unit, 2) : "-");
    relative.push_back(sure ? per_cent(e.standard_error, e.value) : "-");
    truths.push_back(significant(e.truth / e.unit, 7));
    off.push_back({sure ? fmt::format("{:+.1f}", error) : "-", std::abs(error) > remarkable ? Tone::bad : Tone::plain});
  }
  Table table;
  table.add_text_column("parameter", names);
  table.add_text_column("estimate", values);
  if (any) {
    table.add_number_column("deviation", deviations);
    table.add_number_column("per cent", relative);
  }
  table.add_text_column("unit", parameter_units(problem));
  if (any && problem.experiment().is_simulated()) {
    table.add_number_column("truth", truths);
    table.add_text_column("off, in deviations", off);
  }
  table.add_text_column("", notes);
  return section(fitted.usable() ? "Estimates" : "Reached, but no estimates", table.print(palette), palette);
}

std::string run_section(const FitProblem& problem, const Fit& fitted, const Palette& palette) {
  const Experiment& experiment = problem.experiment();
  constexpr std::size_t most_sensors = 4;
  const std::size_t sensors = std::min(most_sensors, experiment.sensors.size());
  const std::vector<std::size_t> order = worst_first(problem, fitted);
  std::vector<std::string> names, over_noise, lagged;
  std::vector<Cell> white;
  std::vector<std::vector<std::string>> rms(sensors);
  for (const std::size_t r : order) {
    const RunFit& run = fitted.runs[r];
    names.push_back(one_line(run.name));
    over_noise.push_back(significant(rms_over_noise(problem, run), residual_digits));
    double largest = 0.0;
    for (const double a : run.autocorrelation) largest = std::abs(a) > std::abs(largest) ? a : largest;
    lagged.push_back(run.rms.empty() ? "-" : fmt::format("{:+.3f}", largest));
    white.push_back({run.white ? "white" : "not white", run.white ? Tone::plain : Tone::doubtful});
    for (std::size_t k = 0; k < sensors; ++k) {
      rms[k].push_back(run.rms.empty()
                           ? "-"
                           : significant(run.rms[k] / experiment.sensors[k].dimension().unit(experiment.scene.units),
                                         residual_digits));
    }
  }
  Table table;
  table.add_text_column("run", names);
  table.add_number_column("over noise", over_noise);
  for (std::size_t k = 0; k < sensors; ++k) {
    const Sensor& sensor = experiment.sensors[k];
    table.add_number_column(fmt::format("{} ({})", sensor.name, sensor.dimension().unit_name(experiment.scene.units)),
                            rms[k]);
  }
  table.add_number_column("autocorrelation", lagged);
  table.add_text_column("", white);
  return section("Residuals of the runs: root mean squares, the worst first", table.print(palette), palette);
}

}  // namespace

std::string identify_report(const FitProblem& problem, const FitAnswer& answer, const Palette& palette) {
  const Fit& fitted = answer.fit;
  std::string out = heading(problem.experiment(), palette) + verdict(fitted, palette) + facts(problem, answer, palette);
  out += estimate_section(problem, fitted, palette);
  out += correlation_section(problem, fitted.identifiability, palette);
  out += untold_section(fitted.identifiability, palette);
  return out + run_section(problem, fitted, palette);
}

}  // namespace poise::app
