#include "app/fit_files.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/csv_file.hpp"
#include "app/identifiability_json.hpp"
#include "app/json_parts.hpp"
#include "app/quantity.hpp"
#include "app/report/experiment_parts.hpp"
#include "identification/residuals.hpp"

namespace poise::app {
namespace {

constexpr std::size_t most_sensors_drawn = 3;
constexpr std::size_t most_runs_drawn = 4;
constexpr std::size_t most_parameters_drawn = 8;

std::vector<double> shown(std::vector<double> si, const Sensor& sensor, const Units& units) {
  for (double& value : si) value /= sensor.dimension().unit(units);
  return si;
}

std::string axis(const std::string& what, const Sensor& sensor, const Units& units) {
  return fmt::format("{} ({})", what, sensor.dimension().unit_name(units));
}

Panel fitted_panel(const FitProblem& problem, const FitAnswer& answer, std::size_t r, std::size_t k) {
  const Sensor& sensor = problem.experiment().sensors[k];
  const Units& units = problem.experiment().scene.units;
  const Record& record = answer.records[r];
  std::vector<double> predicted = residuals_of(problem, answer.fit, answer.records, r).prediction[k];
  Panel panel{.title = fmt::format("{} of run {}, the worst", sensor.name, problem.run(r).run().name),
              .y_label = axis("reading", sensor, units)};
  panel.curves = {
      {.name = "read", .x = record.time, .y = shown(record.reading[k], sensor, units), .style = Curve::Style::points},
      {.name = "fitted", .x = record.time, .y = shown(std::move(predicted), sensor, units)}};
  return panel;
}

Panel residual_panel(const FitProblem& problem, const FitAnswer& answer, const std::vector<std::size_t>& worst,
                     std::size_t k) {
  const Sensor& sensor = problem.experiment().sensors[k];
  const Units& units = problem.experiment().scene.units;
  Panel panel{.title = fmt::format("{}: residuals of the {}", sensor.name, worst.size() > 1 ? "worst runs" : "run"),
              .y_label = axis("read - fitted", sensor, units)};
  for (std::size_t i = 0; i < std::min(most_runs_drawn, worst.size()); ++i) {
    panel.curves.push_back(
        {.name = problem.run(worst[i]).run().name,
         .x = answer.records[worst[i]].time,
         .y = shown(residuals_of(problem, answer.fit, answer.records, worst[i]).residual[k], sensor, units),
         .style = answer.fit.runs[worst[i]].white ? Curve::Style::points : Curve::Style::line});
  }
  const double two = 2 * sensor.noise / sensor.dimension().unit(units);
  panel.bands = {{.low = -two, .high = two, .name = "2 deviations of the noise"}};
  return panel;
}

/// Each curve of FitProblem::sensitivities() over its largest value, which its name gives: parameters whose curves are
/// alike cannot be identified separately.
std::vector<Panel> sensitivity_panels(const FitProblem& problem, const FitAnswer& answer, std::size_t r,
                                      std::size_t sensors) {
  const auto curves = problem.sensitivities(r, answer.fit.parameters, answer.fit.runs[r].nuisances);
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < sensors; ++k) {
    const Sensor& sensor = problem.experiment().sensors[k];
    panels.push_back(
        {.title = fmt::format("{} of run {}: what the parameters do", sensor.name, problem.run(r).run().name),
         .x_label = "time (s)",
         .y_label = "effect over its largest"});
    const std::size_t count = curves.empty() ? 0 : std::min(most_parameters_drawn, curves[k].size());
    for (std::size_t c = 0; c < count; ++c) {
      const auto p = static_cast<std::size_t>(problem.parameters_of(r)[c]);
      Curve curve{.name = problem.parameters()[p].name, .x = answer.records[r].time, .y = curves[k][c]};
      const auto size = [](double a, double b) { return std::abs(a) < std::abs(b); };
      const double largest = std::abs(*std::max_element(curve.y.begin(), curve.y.end(), size));
      for (double& y : curve.y) y = largest > 0 ? y / largest : 0.0;
      curve.name += fmt::format(", up to {} σ", significant(largest, 2));
      panels.back().curves.push_back(std::move(curve));
    }
  }
  return panels;
}

Json json_estimates(const FitProblem& problem, const FitAnswer& answer) {
  const Fit& fitted = answer.fit;
  const std::vector<std::string> units = parameter_units(problem);
  const bool simulated = problem.experiment().is_simulated();
  Json out = Json::array();
  for (std::size_t i = 0; i < fitted.estimates.size(); ++i) {
    const Estimate& e = fitted.estimates[i];
    const auto number = [&](double si, bool known) {
      return known && !e.withheld ? json_number(si / e.unit) : Json(nullptr);
    };
    out.push_back({{"name", e.name},
                   {"path", problem.unknown_of(i).path},
                   {"unit", units[i]},
                   {"value", number(e.value, true)},
                   {"deviation", number(e.standard_error, fitted.identifiability.ok)},
                   {"truth", number(e.truth, simulated)},
                   {"withheld", e.withheld ? Json(e.why) : Json(nullptr)}});
  }
  return out;
}

Json json_rms(const std::vector<double>& rms, const Experiment& experiment) {
  Json out = Json::array();
  for (std::size_t k = 0; k < rms.size(); ++k) {
    out.push_back(json_number(rms[k] / experiment.sensors[k].dimension().unit(experiment.scene.units)));
  }
  return out;
}

Json json_runs(const FitProblem& problem, const Fit& fitted) {
  const Units& units = problem.experiment().scene.units;
  Json out = Json::array();
  for (std::size_t r = 0; r < fitted.runs.size(); ++r) {
    const RunFit& run = fitted.runs[r];
    const std::vector<std::string> names = problem.run(r).nuisance_names();
    const std::vector<Dimension> dimensions = problem.run(r).nuisance_dimensions();
    Json found = Json::object();
    for (std::size_t i = 0; i < run.nuisances.size(); ++i) {
      found[names[i]] = json_number(run.nuisances[i] / dimensions[i].unit(units));
    }
    Json lagged = Json::array();
    for (const double a : run.autocorrelation) lagged.push_back(json_number(a));
    out.push_back({{"name", run.name},
                   {"rms", json_rms(run.rms, problem.experiment())},
                   {"rms_over_noise", json_number(rms_over_noise(problem, run))},
                   {"autocorrelation", lagged},
                   {"white", run.white},
                   {"nuisances", found}});
  }
  return out;
}

}  // namespace

std::string fit_json(const FitProblem& problem, const FitAnswer& answer, const std::vector<std::string>& settings) {
  const Fit& fitted = answer.fit;
  const Experiment& experiment = problem.experiment();
  Json out = json_experiment(problem, settings);
  out["status"] = to_string(fitted.status);
  out["why"] = fitted.why;
  out["start"] = fitted.start;
  out["degrees_of_freedom"] = fitted.degrees_of_freedom;
  out["misfit"] = fitted.runs.empty() ? Json(nullptr) : json_number(fitted.residual_over_noise);
  out["colour"] = fitted.runs.empty() ? Json(nullptr) : json_number(fitted.autocorrelation_factor);
  out["misfit_deviation"] = fitted.runs.empty() ? Json(nullptr) : json_number(fitted.residual_over_noise_sigma);
  out["iterations"] = fitted.iterations;
  out["evaluations"] = fitted.evaluations;
  out["tries"] = fitted.tries;
  out["microseconds"] = json_number(fitted.microseconds);
  out["estimates"] = json_estimates(problem, answer);
  out["identifiability"] = json_identifiability(problem, fitted.identifiability);
  out["sensors"] = Json::array();
  for (const Sensor& sensor : experiment.sensors) {
    out["sensors"].push_back({{"name", sensor.name},
                              {"unit", sensor.dimension().unit_name(experiment.scene.units)},
                              {"noise", json_number(sensor.noise / sensor.dimension().unit(experiment.scene.units))}});
  }
  out["rms"] = json_rms(fitted.rms, experiment);
  out["rms_from_first_readings"] =
      answer.rms_from_readings.empty() ? Json(nullptr) : json_rms(answer.rms_from_readings, experiment);
  out["residuals"] = json_runs(problem, fitted);
  return json_text(out, experiment.scene);
}

std::string residuals_csv(const FitProblem& problem, const FitAnswer& answer) {
  if (answer.fit.runs.empty()) return "";
  const Experiment& experiment = problem.experiment();
  std::vector<std::string> header = {"run", "time"};
  for (const Sensor& sensor : experiment.sensors) {
    header.insert(header.end(), {sensor.name, sensor.name + ".prediction", sensor.name + ".residual"});
  }
  std::vector<std::vector<double>> columns(header.size() - 1);
  std::vector<std::string> runs;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const Record& record = answer.records[r];
    runs.insert(runs.end(), record.time.size(), problem.run(r).run().name);
    columns[0].insert(columns[0].end(), record.time.begin(), record.time.end());
    const RunResiduals residuals = residuals_of(problem, answer.fit, answer.records, r);
    for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
      for (std::size_t s = 0; s < record.time.size(); ++s) {
        const double values[] = {record.reading[k][s], residuals.prediction[k][s], residuals.residual[k][s]};
        for (std::size_t c = 0; c < 3; ++c) {
          columns[1 + 3 * k + c].push_back(values[c] / experiment.sensors[k].dimension().unit(experiment.scene.units));
        }
      }
    }
  }
  return csv_text(header, columns, {runs});
}

int plot_columns(const Experiment& experiment) {
  return static_cast<int>(std::min(most_sensors_drawn, experiment.sensors.size()));
}

std::vector<Panel> fit_panels(const FitProblem& problem, const FitAnswer& answer) {
  if (answer.fit.runs.empty()) return {};
  const std::vector<std::size_t> worst = worst_first(problem, answer.fit);
  const auto sensors = static_cast<std::size_t>(plot_columns(problem.experiment()));
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < sensors; ++k) panels.push_back(fitted_panel(problem, answer, worst.front(), k));
  for (std::size_t k = 0; k < sensors; ++k) panels.push_back(residual_panel(problem, answer, worst, k));
  for (Panel& panel : sensitivity_panels(problem, answer, worst.front(), sensors)) panels.push_back(std::move(panel));
  return panels;
}

}  // namespace poise::app
