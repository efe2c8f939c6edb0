#include "app/results/identification/identify.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "app/results/parts.hpp"
#include "identification/residuals.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr int residual_digits = 3;
// An estimate that differs by more standard errors from the truth of a simulation is marked.
constexpr double remarkable = 4.0;
// Residuals with the autocorrelation a carry the information of (1 - a)/(1 + a) times as many independent ones: half.
constexpr double not_independent = 1.0 / 3.0;

int withheld(const Fit& fitted) {
  return static_cast<int>(
      std::count_if(fitted.estimates.begin(), fitted.estimates.end(), [](const Estimate& e) { return e.withheld; }));
}

/// The largest autocorrelation of any sensor in any run.
double largest_autocorrelation(const Fit& fitted) {
  double largest = 0.0;
  for (const RunFit& run : fitted.runs) {
    for (const double a : run.autocorrelation) largest = std::max(largest, a);
  }
  return largest;
}

Line verdict(const Fit& fitted) {
  switch (fitted.status) {
    case FitStatus::converged:
      return good("Converged: residuals agree with the stated noise.");
    case FitStatus::misfit:
      return doubtful(fmt::format("Converged with a misfit: {}.", fitted.why));
    case FitStatus::not_run:
    case FitStatus::failed:
    case FitStatus::interrupted:
      break;
  }
  return bad(fmt::format("No fit: {}.", fitted.why));
}

std::vector<Line> warnings(const Fit& fitted) {
  std::vector<Line> out;
  if (!fitted.usable()) return out;
  if (withheld(fitted) > 0) {
    const std::string all = count(static_cast<int>(fitted.estimates.size()), "estimate", "estimates");
    out.push_back(bad(fmt::format("Withheld: {} of {}, see below.", withheld(fitted), all)));
  }
  if (largest_autocorrelation(fitted) > not_independent) {
    out.push_back(
        doubtful(fmt::format("Residuals are correlated from one sample to the next (autocorrelation up to "
                             "{:.3f}): standard errors are larger than shown, by about {} times.",
                             largest_autocorrelation(fitted), significant(fitted.autocorrelation_factor, 2))));
  }
  if (!fitted.identifiability.ok) {
    out.push_back(bad("Standard errors are not known: " + fitted.identifiability.why + "."));
  }
  return out;
}

void add_estimates(Group& group, const FitProblem& problem, const Fit& fitted) {
  const std::vector<Estimate>& rows = fitted.estimates;
  const bool known = fitted.identifiability.ok;
  const bool any = withheld(fitted) < static_cast<int>(rows.size());
  const bool simulated = problem.experiment().is_simulated();
  // What is withheld has no number, and no text in the columns behind the estimate.
  const auto number = [&](double Estimate::*si, bool there) {
    return each(rows, [&](const Estimate& e) { return e.withheld || !there ? NAN : e.*si / e.unit; });
  };
  const auto text = [&](auto&& of) {
    return each(rows, [&](const Estimate& e) { return e.withheld ? std::string() : of(e); });
  };
  const auto difference_of = [](const Estimate& e) { return (e.value - e.truth) / e.standard_error; };
  Table& table = group.table("estimates", fitted.usable() ? "Estimates" : "Values reached, no estimates", Rows::list);
  table.words("name", "parameter", each(rows, &Estimate::name));
  table.words("path", "", each(places(rows.size()), [&](std::size_t i) { return problem.unknown_of(i).path; })).shown =
      false;
  table
      .words("", "estimate",
             each(rows,
                  [&](const Estimate& e) {
                    return e.withheld ? "withheld"
                                      : rounded_to(e.value / e.unit, known ? e.standard_error / e.unit : 0.0);
                  }))
      .tones = each(rows, [](const Estimate& e) { return e.withheld ? Tone::bad : Tone::plain; });
  table.data("value", number(&Estimate::value, true));
  Column& errors = table.numbers("standard_error", "standard error", "", number(&Estimate::standard_error, known));
  errors.texts = text([&](const Estimate& e) { return significant(known ? e.standard_error / e.unit : NAN, 2); });
  errors.shown = any;
  Column& per_cents = table.numbers("", "per cent", "", {});
  per_cents.texts = text([&](const Estimate& e) { return known ? per_cent(e.standard_error, e.value) : "-"; });
  per_cents.shown = any;
  table.words("unit", "unit", rows.empty() ? std::vector<std::string>{} : parameter_units(problem));
  Column& truth = table.numbers("truth", "truth", "", number(&Estimate::truth, simulated));
  truth.texts = text([&](const Estimate& e) { return significant(simulated ? e.truth / e.unit : NAN, 7); });
  truth.shown = any && simulated;
  Column& difference =
      table.words("", "error / sigma",
                  text([&](const Estimate& e) { return known ? fmt::format("{:+.1f}", difference_of(e)) : "-"; }));
  difference.tones = each(rows, [&](const Estimate& e) {
    return !e.withheld && std::abs(difference_of(e)) > remarkable ? Tone::bad : Tone::plain;
  });
  difference.shown = any && simulated;
  Column& why = table.remarks(each(rows, &Estimate::why), Tone::bad);
  why.key = "withheld";
  why.kind = Column::Kind::word_or_null;
}

std::vector<double> in_units(const std::vector<double>& rms, const Experiment& experiment) {
  std::vector<double> out;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    out.push_back(rms[k] / experiment.sensors[k].dimension().unit(experiment.scene.units));
  }
  return out;
}

/// "phi1 0.00292 rad, phi2 0.00403 rad; all angles 0.00351 rad".
std::string rms_in_words(const std::vector<double>& rms, const Experiment& experiment) {
  const Units& units = experiment.scene.units;
  const std::vector<double> shown = in_units(rms, experiment);
  std::string text;
  double squares = 0.0;
  int angles = 0;
  for (std::size_t k = 0; k < rms.size(); ++k) {
    const Sensor& sensor = experiment.sensors[k];
    text += fmt::format("{}{} {} {}", k > 0 ? ", " : "", sensor.name, significant(shown[k], residual_digits),
                        sensor.dimension().unit_name(units));
    if (sensor.reads_force() || sensor.rate || !sensor.on.is_angle()) continue;
    squares += rms[k] * rms[k];
    ++angles;
  }
  if (angles < 2) return text;
  return text + fmt::format("; all angles {} {}",
                            significant(std::sqrt(squares / angles) / units.angle, residual_digits), units.angle_name);
}

void add_runs(Group& section, const FitProblem& problem, const Fit& fitted) {
  const Experiment& experiment = problem.experiment();
  constexpr std::size_t most_sensors = 4;
  const std::size_t sensors = std::min(most_sensors, experiment.sensors.size());
  std::vector<RunFit> rows;
  for (const std::size_t r : worst_first(problem, fitted)) rows.push_back(fitted.runs[r]);
  const auto lagged = [](const RunFit& run) {
    const auto largest = largest_by_size(run.autocorrelation);
    return largest == run.autocorrelation.end() ? "-" : fmt::format("{:+.3f}", *largest);
  };
  Table& table = section.table("", "Residuals of the runs: root mean squares, the worst first", Rows::list);
  table.words("", "run", each(rows, [](const RunFit& run) { return one_line(run.name); }));
  table.numbers("", "over noise", "", {}).texts =
      each(rows, [&](const RunFit& run) { return significant(rms_over_noise(problem, run), residual_digits); });
  for (std::size_t k = 0; k < sensors; ++k) {
    const Sensor& sensor = experiment.sensors[k];
    table.numbers("", sensor.name, sensor.dimension().unit_name(experiment.scene.units), {}).texts =
        each(rows, [&](const RunFit& run) {
          return run.rms.empty() || std::isnan(run.rms[k])
                     ? "-"
                     : significant(in_units(run.rms, experiment)[k], residual_digits);
        });
  }
  table.numbers("", "autocorrelation", "", {}).texts = each(rows, lagged);
  table.words("", "", each(rows, [](const RunFit& run) { return run.white ? "white" : "not white"; })).tones =
      each(rows, [](const RunFit& run) { return run.white ? Tone::plain : Tone::doubtful; });
}

void add_residuals(Group& content, const FitProblem& problem, const FitAnswer& answer) {
  const Fit& fitted = answer.fit;
  if (fitted.runs.empty()) return;
  const Experiment& experiment = problem.experiment();
  Group& section = content.group("", "Residuals");
  const auto white = std::count_if(fitted.runs.begin(), fitted.runs.end(), [](const RunFit& r) { return r.white; });
  section.fact("over noise",
               fmt::format("{}, expected 1 ± {}; white in {} of {}", significant(fitted.residual_over_noise, 4),
                           significant(2 * fitted.residual_over_noise_sigma, 2), white,
                           count(static_cast<int>(fitted.runs.size()), "run", "runs")));
  section.fact("rms", rms_in_words(fitted.rms, experiment));
  if (!answer.rms_from_readings.empty()) {
    section.fact("unfitted", rms_in_words(answer.rms_from_readings, experiment) +
                                 ", with the starts estimated from the runs' first readings");
  }
  add_runs(section, problem, fitted);
}

void add_fit_data(Group& content, const FitProblem& problem, const FitAnswer& answer) {
  const Fit& fitted = answer.fit;
  const Experiment& experiment = problem.experiment();
  const Units& units = experiment.scene.units;
  const bool reached = !fitted.runs.empty();
  content.data("status", to_string(fitted.status));
  content.data("why", fitted.why);
  content.data("start", fitted.start);
  content.data("degrees_of_freedom", fitted.degrees_of_freedom);
  content.data("residual_over_noise", reached ? Value(fitted.residual_over_noise) : Value());
  content.data("residual_over_noise_sigma", reached ? Value(fitted.residual_over_noise_sigma) : Value());
  content.data("autocorrelation_factor", reached ? Value(fitted.autocorrelation_factor) : Value());
  content.data("iterations", fitted.iterations);
  content.data("evaluations", fitted.evaluations);
  content.data("tries", fitted.tries);
  content.data("microseconds", fitted.microseconds);
  Table& sensors = content.table("sensors", "", Rows::list, Verbosity::data);
  sensors.words("name", "", each(experiment.sensors, &Sensor::name));
  sensors.words("unit", "", each(experiment.sensors, [&](const Sensor& s) { return s.dimension().unit_name(units); }));
  sensors.data("noise", each(experiment.sensors, [&](const Sensor& s) { return s.noise / s.dimension().unit(units); }));
  content.data("rms", in_units(fitted.rms, experiment));
  content.data("rms_from_first_readings",
               answer.rms_from_readings.empty() ? Value() : Value(in_units(answer.rms_from_readings, experiment)));
  Branch& runs = content.array("residuals");
  for (std::size_t r = 0; r < fitted.runs.size(); ++r) {
    const RunFit& run = fitted.runs[r];
    Group& one = runs.parts.emplace_back();
    one.data("name", run.name);
    one.data("rms", in_units(run.rms, experiment));
    one.data("rms_over_noise", rms_over_noise(problem, run));
    one.data("autocorrelation", run.autocorrelation);
    one.data("white", run.white);
    const std::vector<std::string> nuisances = problem.run(r).nuisance_names();
    const std::vector<Dimension> dimensions = problem.run(r).nuisance_dimensions();
    Group& found = one.group("nuisances", "", Verbosity::data);
    for (std::size_t i = 0; i < run.nuisances.size(); ++i) {
      found.data(nuisances[i], run.nuisances[i] / dimensions[i].unit(units));
    }
  }
}

}  // namespace

Result identify_result(const FitProblem& problem, const FitAnswer& answer, const std::vector<std::string>& settings) {
  const Fit& fitted = answer.fit;
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(fitted);
  out.warnings = warnings(fitted);
  Group& content = out.content;
  add_estimates(content, problem, fitted);
  add_null_directions(content, fitted.identifiability);
  add_correlations(content, problem, fitted.identifiability);
  add_identifiability_data(content, problem, fitted.identifiability);
  add_residuals(content, problem, answer);
  add_fit_data(content, problem, answer);
  Group& numerics = content.group("", "Numerics");
  numerics.fact("data", data_in_words(problem));
  if (!fitted.start.empty()) numerics.fact("start", fitted.start);
  numerics.fact("effort",
                fmt::format("Levenberg-Marquardt from {}: {}, {} of all runs with sensitivities, {}",
                            count(fitted.tries, "start", "starts"), count(fitted.iterations, "iteration", "iterations"),
                            count(fitted.evaluations, "evaluation", "evaluations"), duration(fitted.microseconds)));
  return out;
}

void add_readings(Result& result, const FitProblem& problem, const FitAnswer& answer) {
  if (answer.fit.runs.empty()) return;
  const Experiment& experiment = problem.experiment();
  std::vector<std::string> runs;
  std::vector<double> times;
  std::vector<std::vector<double>> columns(3 * experiment.sensors.size());
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const std::vector<Series>& sensors = answer.records[r].sensors;
    std::vector<double> when;
    for (const Series& series : sensors) when.insert(when.end(), series.time.begin(), series.time.end());
    std::sort(when.begin(), when.end());
    when.erase(std::unique(when.begin(), when.end()), when.end());
    runs.insert(runs.end(), when.size(), problem.run(r).run().name);
    times.insert(times.end(), when.begin(), when.end());
    const RunResiduals found = residuals_of(problem, answer.fit, answer.records, r);
    for (std::size_t k = 0; k < sensors.size(); ++k) {
      const double unit = experiment.sensors[k].dimension().unit(experiment.scene.units);
      std::size_t s = 0;
      for (const double time : when) {
        const bool read = s < sensors[k].time.size() && sensors[k].time[s] == time;
        columns[3 * k].push_back(read ? sensors[k].value[s] / unit : nan);
        columns[3 * k + 1].push_back(read ? found.prediction[k][s] / unit : nan);
        columns[3 * k + 2].push_back(read ? found.residual[k][s] / unit : nan);
        if (read) ++s;
      }
    }
  }
  // Not in JSON, for its size.
  Table& table = result.content.table("", "", Rows::columns, Verbosity::data);
  table.csv = true;
  table.words("run", "", std::move(runs));
  table.data("time", std::move(times));
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    const std::string& name = experiment.sensors[k].name;
    table.data(name, std::move(columns[3 * k]));
    table.data(name + ".prediction", std::move(columns[3 * k + 1]));
    table.data(name + ".residual", std::move(columns[3 * k + 2]));
  }
}

}  // namespace poise::app
