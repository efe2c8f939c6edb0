#include "identification/prediction/static_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "solvers/newton.hpp"
#include "solvers/random_stream.hpp"
#include "statics/friction/held.hpp"
#include "statics/model/mobility.hpp"
#include "statics/sensitivity/sensitivity.hpp"

namespace poise {
namespace {

/// rad or mechanism sizes by which a drive moves its measure in one step to a position.
constexpr double longest_drive_step = 0.1;
constexpr int most_drive_steps = 1000;

/// What a sensor reads at rest.
SoughtQuantity quantity_of(const Sensor& sensor) {
  if (sensor.quantity) return *sensor.quantity;
  SoughtQuantity out;
  out.name = sensor.name;
  out.on = sensor.on;
  out.dimension = sensor.dimension();
  if (!sensor.reads_force()) return out;
  out.kind = SoughtQuantity::Kind::element_force;
  out.item = sensor.element;
  return out;
}

/// The force of a drive is that of the stop that stands for it: with equal limits, positive where it tends to increase
/// its measure.
void read_from_stops(SoughtQuantity& quantity, const Scene& scene, std::size_t first_held) {
  for (SoughtQuantity& part : quantity.of) read_from_stops(part, scene, first_held);
  if (quantity.kind != SoughtQuantity::Kind::drive_force) return;
  for (std::size_t s = first_held; s < scene.stops.size(); ++s) {
    if (!is_same(scene.stops[s].on, quantity.on)) continue;
    quantity.kind = SoughtQuantity::Kind::stop_reaction;
    quantity.item = static_cast<int>(s);
  }
}

/// Why an equilibrium, or a quantity of it, cannot be used; without the end of the sentence.
std::string first_why(const Sensitivities& found) {
  if (!found.why.empty()) return found.why;
  for (const QuantitySensitivity& one : found.of) {
    if (!one.why.empty()) return fmt::format("{}: {}", one.of.name, one.why);
  }
  return "";
}

}  // namespace

StaticRun::StaticRun(const Experiment& experiment, std::size_t run, const Scene& scene) : run_(experiment.runs[run]) {
  for (std::size_t k = 0; k < experiment.sensors.size(); ++k) {
    if (!run_.reads(k)) continue;
    if (!experiment.sensors[k].is_of_rest()) {
      throw InputError(
          fmt::format("{}:{}: run \"{}\": expected sensors that read at rest, \"{}\" reads what only motions have",
                      experiment.file_of(run_.part), run_.line, run_.name, experiment.sensors[k].name));
    }
    const auto at = static_cast<Eigen::Index>(sensors_.size());
    sensors_.push_back(k);
    if (experiment.sensors[k].slips) {
      slips_.push_back({at, *experiment.sensors[k].slips});
      continue;
    }
    at_.push_back(at);
    quantities_.push_back(quantity_of(experiment.sensors[k]));
  }
  drives_ = std::any_of(run_.row_inputs.begin(), run_.row_inputs.end(),
                        [](const RowInput& input) { return input.drive >= 0; });
  const Scene held = with(scene, inputs(0));
  for (SoughtQuantity& quantity : quantities_) read_from_stops(quantity, held, scene.stops.size());
}

std::vector<double> StaticRun::inputs(std::size_t row) const {
  std::vector<double> out;
  for (const RowInput& input : run_.row_inputs) out.push_back(input.values[row]);
  return out;
}

std::vector<double> StaticRun::random_inputs(std::uint64_t index) const {
  solvers::RandomStream random(11, 0, index);
  std::vector<double> out;
  for (const RowInput& input : run_.row_inputs) {
    const auto [least, most] = std::minmax_element(input.values.begin(), input.values.end());
    const double half = *least < *most ? 0.0 : 0.5 * std::abs(*least);
    out.push_back(random.uniform(*least - half, *most + half));
  }
  return out;
}

/// The scene with the inputs of a row; drives that are inputs are stops with equal limits behind all others.
Scene StaticRun::with(Scene scene, const std::vector<double>& inputs) const {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const RowInput& input = run_.row_inputs[i];
    if (input.drive < 0) {
      set_value(scene, input.path, inputs[i]);
      continue;
    }
    const Drive& drive = scene.drives[static_cast<std::size_t>(input.drive)];
    Stop hold;
    hold.name = "drive." + drive.name;
    hold.on = drive.on;
    hold.min = hold.max = inputs[i] * drive.on.dimension().unit(scene.units);
    hold.line = drive.line;
    scene.stops.push_back(std::move(hold));
  }
  return scene;
}

/// The closed position that drives hold, scaled coordinates, reached in steps from where the mechanism is assembled.
std::vector<double> StaticRun::start_of(const Scene& held) const {
  Scene at = held;
  std::vector<Stop*> holds;
  for (const RowInput& input : run_.row_inputs) {
    if (input.drive >= 0) holds.push_back(nullptr);
  }
  const std::size_t first = at.stops.size() - holds.size();
  for (std::size_t h = 0; h < holds.size(); ++h) holds[h] = &at.stops[first + h];
  // Without what holds, then with the values that the measures have there.
  Scene free = held;
  free.stops.resize(first);
  const StaticModel model(held);
  const ScaledModel assembled(std::move(free), Purpose::statics, model.scales());
  std::vector<double> x = close_loops(assembled);
  std::vector<double> from, to;
  double longest = 0.0;
  const Mechanism<double>& mechanism = model.mechanism();
  std::vector<Planar<double>> pose(static_cast<std::size_t>(mechanism.pose_size()));
  std::vector<double> c(static_cast<std::size_t>(mechanism.constraints()));
  mechanism.place(x.data(), pose.data());
  mechanism.constraint(x.data(), pose.data(), c.data());
  for (std::size_t h = 0; h < holds.size(); ++h) {
    const double unit = holds[h]->on.dimension().per_scale(model.scales());
    from.push_back(c[static_cast<std::size_t>(mechanism.stop_row(static_cast<int>(first + h)))] / unit);
    to.push_back(holds[h]->min);
    longest = std::max(longest, std::abs(to.back() - from.back()) * unit);
  }
  const int steps = std::clamp(static_cast<int>(std::ceil(longest / longest_drive_step)), 1, most_drive_steps);
  for (int step = 1; step <= steps; ++step) {
    for (std::size_t h = 0; h < holds.size(); ++h) {
      holds[h]->min = holds[h]->max = from[h] + (to[h] - from[h]) * step / steps;
    }
    const StaticModel here(at, model.scales());
    solvers::Newton closing(here.problem());
    const solvers::NewtonResult& closed = closing.close(x);
    if (closed.end != solvers::NewtonEnd::converged) {
      throw InputError("its drives cannot be brought to the positions that they hold");
    }
    x = closed.x;
  }
  return x;
}

StaticRun::Row StaticRun::read(const Scene& scene, const std::vector<double>& inputs,
                               const std::vector<SceneParameter>& numbers, const std::atomic<bool>* interrupt) const {
  Row out;
  const auto count = static_cast<Eigen::Index>(sensors_.size());
  out.value.resize(count);
  out.by = out.error = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(numbers.size()));
  try {
    read_slips(scene, inputs, numbers, out);
    if (!out.ok() || quantities_.empty()) return out;
    const StaticModel model(with(scene, inputs));
    SensitivityOptions options;
    options.solve.interrupt = interrupt;
    if (drives_) options.start = start_of(model.scene());
    const Sensitivities found = sensitivities(model, quantities_, options);
    out.why = first_why(found);
    if (!out.ok()) return out;
    for (std::size_t q = 0; q < found.of.size(); ++q) {
      const QuantitySensitivity& of = found.of[q];
      out.value[at_[q]] = of.value;
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        const auto by = std::find_if(of.by.begin(), of.by.end(),
                                     [&](const Sensitivity& s) { return s.number == numbers[i].path(); });
        if (by == of.by.end()) continue;  // equilibria do not depend on it
        if (!by->why.empty()) {
          out.why = fmt::format("{} by {}: {}", of.of.name, by->number, by->why);
          return out;
        }
        out.by(at_[q], static_cast<Eigen::Index>(i)) = by->derivative;
      }
    }
  } catch (const InputError& error) {
    out.why = error.what();
  }
  return out;
}

std::optional<double> StaticRun::slips_at(const Sensor::SlipLoad& load, const Scene& scene,
                                          const std::vector<double>& inputs, std::string& why) const {
  Scene held = with(scene, inputs), free = held;
  free.stops.resize(scene.stops.size());
  const StaticModel model(free);
  const std::vector<double> x = drives_ ? start_of(held) : close_loops(model);
  const HeldRange range = held_range(model, x, load.path);
  if (!range.any) {
    why = fmt::format("{}: {}", load.path, range.why.empty() ? "no load holds it there" : range.why);
    return std::nullopt;
  }
  const bool upper = load.falling == (range.present < 0.0);
  const HeldEnd& end = upper ? range.upper : range.lower;
  if (end.at_limit || !std::isfinite(end.value)) {
    why = fmt::format("{}: it slips at none as it {}", load.path, load.falling ? "falls" : "grows");
    return std::nullopt;
  }
  return end.value;
}

void StaticRun::read_slips(const Scene& scene, const std::vector<double>& inputs,
                           const std::vector<SceneParameter>& numbers, Row& out) const {
  constexpr double part = 1e-3;  // of a number's size
  for (const SlipSensor& sensor : slips_) {
    const std::optional<double> value = slips_at(sensor.load, scene, inputs, out.why);
    if (!value) return;
    out.value[sensor.at] = *value;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      const SceneParameter& number = numbers[i];
      const double now = number.get(scene);
      const double step = part * (now != 0.0 ? std::abs(now) : 1.0);
      const auto moved = [&](double by) {
        Scene other = scene;
        number.set(other, now + by * step);
        return slips_at(sensor.load, other, inputs, out.why).value_or(NAN);
      };
      const bool both = number.allows(scene, now + 2 * step) && number.allows(scene, now - 2 * step);
      const double sign = number.allows(scene, now + 2 * step) ? 1.0 : -1.0;
      const double near =
          both ? (moved(1) - moved(-1)) / 2 : sign * (4 * moved(sign) - 3 * *value - moved(2 * sign)) / 2;
      const double half = both ? moved(0.5) - moved(-0.5) : sign * (4 * moved(0.5 * sign) - 3 * *value - moved(sign));
      if (!out.ok()) return;
      // Errors of the step's square cancel.
      const double slope = half + (half - near) / 3.0;
      const auto column = static_cast<Eigen::Index>(i);
      out.by(sensor.at, column) = slope / step;
      out.error(sensor.at, column) = std::abs(half - near) / step + 1e-12 * std::abs(*value) / step;
    }
  }
}

std::vector<StaticRun::Row> StaticRun::read(const Scene& scene, const std::vector<SceneParameter>& numbers,
                                            std::size_t last, const std::atomic<bool>* interrupt) const {
  std::vector<Row> out;
  std::map<std::vector<double>, std::size_t> known;
  for (std::size_t row = 0; row < std::min(last, run_.rows); ++row) {
    const auto [at, fresh] = known.try_emplace(inputs(row), row);
    out.push_back(fresh ? read(scene, at->first, numbers, interrupt) : out[at->second]);
    if (out.back().ok()) continue;
    out.back().why = fmt::format("row {}: {}", row + 1, out.back().why);
    break;
  }
  return out;
}

}  // namespace poise
