#include "identification/experiment/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "model/parameters.hpp"

namespace poise {

double written_value(const Experiment& experiment, const Unknown& unknown) {
  if (unknown.of_sensor) return experiment.sensors[unknown.of_sensor->sensor].number(unknown.of_sensor->of);
  const Scene& scene = experiment.scene_of(unknown.part);
  return value_at(scene, parameter(scene, unknown.path).place).value_or(0.0);
}

Dimension dimension_of(const Experiment& experiment, const Unknown& unknown) {
  if (unknown.of_sensor) return experiment.sensors[unknown.of_sensor->sensor].dimension(unknown.of_sensor->of);
  return parameter(experiment.scene_of(unknown.part), unknown.path).dimension;
}

namespace {

std::vector<std::string> measured_inputs_that(const Experiment& experiment,
                                              const std::function<bool(const RunInput&)>& are) {
  std::vector<std::string> paths;
  for (const Run& run : experiment.runs) {
    if (run.is_simulated()) continue;
    for (const RunInput& input : run.inputs) {
      if (are(input) && std::find(paths.begin(), paths.end(), input.path) == paths.end()) paths.push_back(input.path);
    }
  }
  return paths;
}

}  // namespace

std::vector<std::string> measured_inputs(const Experiment& experiment) {
  return measured_inputs_that(experiment, [](const RunInput&) { return true; });
}

std::vector<std::string> exact_inputs(const Experiment& experiment) {
  return measured_inputs_that(experiment, [](const RunInput& input) { return !(input.noise > 0); });
}

std::vector<std::string> noisy_inputs(const Experiment& experiment) {
  return measured_inputs_that(experiment, [](const RunInput& input) { return input.noise > 0; });
}

std::string group_of(const std::string& per, const Run& run) {
  if (per.empty()) return "";
  for (const auto& [label, value] : run.labels) {
    if (label == per) return value;
  }
  return run.name;
}

bool is_held(const Experiment& experiment, const Run& run) {
  const auto moves = [](const Release& release) { return release.rate && release.value != 0; };
  // Rates may also be those of the first readings.
  const auto reads_rate = [&](const Sensor& sensor) {
    return sensor.reads_rate() && run.reads(static_cast<std::size_t>(&sensor - experiment.sensors.data()));
  };
  return !run.unknown_start && experiment.scene_of(run.part).drives.empty() &&
         std::none_of(run.release.begin(), run.release.end(), moves) &&
         (run.is_simulated() || std::none_of(experiment.sensors.begin(), experiment.sensors.end(), reads_rate));
}

TimeRange compared_times(const Experiment& experiment, const Run& run, std::size_t k, double end) {
  if (run.is_at_rest()) return {-INFINITY, INFINITY};
  const Sensor& sensor = experiment.sensors[k];
  // What holds it until then is no part of the scene.
  return {is_held(experiment, run) && !sensor.quantity ? 0.0 : std::max(0.0, sensor.most_delay),
          run.inputs.empty() ? INFINITY : end + std::min(0.0, sensor.least_delay)};
}

std::size_t leave_out(const TimeRange& compared, Series& series) {
  const std::size_t before = series.time.size();
  const auto first = std::lower_bound(series.time.begin(), series.time.end(), compared.from);
  const auto last = std::upper_bound(first, series.time.end(), compared.to);
  const auto value = [&](auto time) { return series.value.begin() + (time - series.time.begin()); };
  series = {{first, last}, {value(first), value(last)}};
  return before - series.time.size();
}

std::vector<double> simulated_times(const Experiment& experiment, const Run& run, std::size_t k) {
  std::vector<double> out;
  if (!run.reads(k) || experiment.sensors[k].reads_impacts()) return out;
  for (std::size_t row = 1; row <= run.rows; ++row) out.push_back(static_cast<double>(row));
  if (run.is_at_rest()) return out;
  const auto count = static_cast<std::size_t>(std::llround(run.duration * run.sample_rate));
  const TimeRange compared = compared_times(experiment, run, k, run.duration);
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) / run.sample_rate;
    if (time >= compared.from && time <= compared.to) out.push_back(time);
  }
  return out;
}

}  // namespace poise
