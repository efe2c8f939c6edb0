#include "app/results/identification/charts.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"
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
  const Series& read = answer.records[r].sensors[k];
  std::vector<double> predicted = residuals_of(problem, answer.fit, answer.records, r).prediction[k];
  Panel panel{.title = fmt::format("{} of run {}, the worst", sensor.name, problem.run(r).run().name),
              .y_label = axis("reading", sensor, units)};
  panel.curves = {
      {.name = "read", .x = read.time, .y = shown(read.value, sensor, units), .style = Curve::Style::points},
      {.name = "fitted", .x = read.time, .y = shown(std::move(predicted), sensor, units)}};
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
         .x = answer.records[worst[i]].sensors[k].time,
         .y = shown(residuals_of(problem, answer.fit, answer.records, worst[i]).residual[k], sensor, units),
         .style = answer.fit.runs[worst[i]].white ? Curve::Style::points : Curve::Style::line});
  }
  const double two = 2 * sensor.noise / sensor.dimension().unit(units);
  panel.bands = {{.low = -two, .high = two, .name = "2 sigma of the noise"}};
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
        {.title = fmt::format("{} of run {}: relative sensitivities", sensor.name, problem.run(r).run().name),
         .x_label = "time (s)",
         .y_label = "sensitivity over its largest"});
    const std::size_t count = curves.empty() ? 0 : std::min(most_parameters_drawn, curves[k].size());
    for (std::size_t c = 0; c < count; ++c) {
      const auto p = static_cast<std::size_t>(problem.parameters_of(r)[c]);
      Curve curve{.name = problem.parameters()[p].name, .x = answer.records[r].sensors[k].time, .y = curves[k][c]};
      const double largest = largest_size(curve.y);
      for (double& y : curve.y) y = largest > 0 ? y / largest : 0.0;
      curve.name += fmt::format(", up to {} σ", significant(largest, 2));
      panels.back().curves.push_back(std::move(curve));
    }
  }
  return panels;
}

}  // namespace

int fit_columns(const Experiment& experiment) {
  return static_cast<int>(std::min(most_sensors_drawn, experiment.sensors.size()));
}

std::vector<Panel> fit_panels(const FitProblem& problem, const FitAnswer& answer) {
  if (answer.fit.runs.empty()) return {};
  const std::vector<std::size_t> worst = worst_first(problem, answer.fit);
  const auto sensors = static_cast<std::size_t>(fit_columns(problem.experiment()));
  std::vector<Panel> panels;
  for (std::size_t k = 0; k < sensors; ++k) panels.push_back(fitted_panel(problem, answer, worst.front(), k));
  for (std::size_t k = 0; k < sensors; ++k) panels.push_back(residual_panel(problem, answer, worst, k));
  for (Panel& panel : sensitivity_panels(problem, answer, worst.front(), sensors)) panels.push_back(std::move(panel));
  return panels;
}

}  // namespace poise::app
