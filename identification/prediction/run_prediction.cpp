// The readings that a run model predicts, with derivatives: members of RunModel.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "identification/prediction/private/quantity_reader.hpp"
#include "identification/prediction/private/sensor_reader.hpp"
#include "identification/prediction/run_model.hpp"

namespace poise {
namespace {

/// Of times, relative to the length of a run.
constexpr double time_rounding = 1e-12;
/// A motion is made longer so often, each time by half, where impacts that were read come later in it.
constexpr int most_times_longer = 3;

/// A sensor in the variation of a number.
struct VariedReader {
  SensorVariation reader;
  std::vector<std::size_t> places;
  std::size_t number;
};

}  // namespace

class RunModel::Readings {
 public:
  Readings(const RunModel& run, const Built& built, const Motion& motion, double duration, bool jacobian)
      : run_(run), built_(built), duration_(duration), column_(static_cast<std::size_t>(motion.trajectory.columns)) {
    readers_.resize(run.times_.size());
    quantities_.resize(run.times_.size());
    places_.resize(run.times_.size());
    varied_.resize(run.times_.size());
    for (std::size_t k = 0; k < run.times_.size(); ++k) {
      if (!run.times_[k].empty() && !run.experiment_.sensors[k].reads_impacts()) add_sensor(k, jacobian);
    }
    const std::vector<Sensor>& sensors = run.experiment_.sensors;
    int derivatives = run.delayed_ ? 1 : 0;
    for (const Sensor& sensor : sensors) {
      derivatives = std::max(derivatives, sensor.reads_acceleration() || sensor.quantity ? 2 : sensor.by_time);
    }
    trajectory_.emplace(motion.trajectory, coordinates_, derivatives);
    for (auto* each : {&q_, &v_, &a_}) each->resize(coordinates_.size());
  }

  /// Moves to the time of a reading of sensor k, not before those moved to, and reads it. Returns the quantity.
  double read(double time, std::size_t k) {
    const double within = std::clamp(time, 0.0, duration_);
    if (within > now_) trajectory_->at(within);
    now_ = within;
    still_ = run_.held_ && time < 0;
    beyond_ = still_ || std::abs(time - within) < time_rounding * run_.end_ ? 0.0 : time - within;
    move_to(k);
    if (quantities_[k]) {
      take_state();
      return quantities_[k]->read(now_, state_);
    }
    return readers_[k]->read(q_.data(), v_.data(), a_.data());
  }

  /// Gives the derivative of the quantity read last by its time.
  double rate_of_change(std::size_t k) {
    if (still_) return 0.0;
    const std::vector<std::size_t>& at = places_[k];
    if (quantities_[k]) {
      std::vector<double> jerk;
      for (const std::size_t i : at) jerk.push_back(moves() ? trajectory_->jerk(i) : 0.0);
      return quantities_[k]->by_time(now_, state_, built_.model->from_si(jerk));
    }
    const SensorReader::Derivatives& by = readers_[k]->derivatives();
    double sum = 0.0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      sum += by.by_q[i] * v_[i];
      if (by.by_v[i] != 0 && beyond_ == 0) sum += by.by_v[i] * trajectory_->a(at[i]);
      if (by.by_a[i] != 0 && beyond_ == 0) sum += by.by_a[i] * trajectory_->jerk(at[i]);
    }
    return sum;
  }

  /// The derivatives of the quantity read last: by f starts, f start rates, the numbers, the one that the equilibrium
  /// sets. A known start follows the numbers. Call it after rate_of_change().
  const std::vector<double>& derivatives(std::size_t k) {
    std::fill(column_.begin(), column_.end(), 0.0);
    const auto starts = static_cast<std::size_t>(2 * run_.freedoms_);
    double* numbers = column_.data() + starts;
    if (quantities_[k]) {
      for (std::size_t c = 0; c < column_.size(); ++c) {
        column_[c] = quantities_[k]->along(now_, state_, change_by(k, c));
        if (c >= starts) column_[c] += quantities_[k]->by_number(c - starts, now_, state_);
      }
      follow_start();
      return column_;
    }
    add_motion(k);
    if (run_.experiment_.sensors[k].reads_force()) add_law(k, numbers);
    for (VariedReader& other : varied_[k]) {
      move_to(other.places, run_.experiment_.sensors[k].reads_acceleration());
      numbers[other.number] += other.reader.read(q_.data(), v_.data(), a_.data());
    }
    follow_start();
    return column_;
  }

  /// The derivatives of the time of an impact.
  const std::vector<double>& derivatives(const ContactEvent& impact) {
    column_ = impact.t_p;
    follow_start();
    return column_;
  }

 private:
  /// Adds to the derivatives by the numbers what comes of a known start.
  void follow_start() {
    const auto starts = static_cast<std::size_t>(2 * run_.freedoms_);
    for (std::size_t i = 0; i < built_.released_by.size(); ++i) {
      column_[starts + i / starts] += column_[i % starts] * built_.released_by[i];
    }
  }

  void add_sensor(std::size_t k, bool jacobian) {
    const Sensor& sensor = run_.experiment_.sensors[k];
    if (sensor.quantity) {
      quantities_[k].emplace(run_.quantity_of(k, built_.model, jacobian));
      std::vector<int> all(built_.q.size());
      std::iota(all.begin(), all.end(), 0);
      places_[k] = places_of(all);
      return;
    }
    readers_[k].emplace(*built_.model, sensor);
    places_[k] = places_of(readers_[k]->coordinates());
    for (std::size_t i = 0; jacobian && i < run_.numbers_.size(); ++i) {
      const int variation = built_.influences[i].variation;
      // The numbers of the whole scene are gravity's, which only accelerometers feel.
      if (variation < 0 || (run_.numbers_[i].place().owner == Owner::scene && !sensor.is_accelerometer())) continue;
      SensorVariation reader(built_.variations[static_cast<std::size_t>(variation)], sensor);
      if (!reader.acts()) continue;
      std::vector<std::size_t> at = places_of(reader.coordinates());
      varied_[k].push_back({std::move(reader), std::move(at), i});
    }
  }

  std::vector<std::size_t> places_of(const std::vector<int>& coordinates) {
    std::vector<std::size_t> found;
    for (const int i : coordinates) {
      const auto known = std::find(coordinates_.begin(), coordinates_.end(), i);
      found.push_back(static_cast<std::size_t>(known - coordinates_.begin()));
      if (known == coordinates_.end()) coordinates_.push_back(i);
    }
    return found;
  }

  void move_to(std::size_t k) {
    const Sensor& sensor = run_.experiment_.sensors[k];
    move_to(places_[k], sensor.reads_acceleration() || sensor.quantity);
  }

  void move_to(const std::vector<std::size_t>& at, bool accelerations) {
    for (std::size_t i = 0; i < at.size(); ++i) {
      q_[i] = trajectory_->q(at[i]) + beyond_ * trajectory_->v(at[i]);
      v_[i] = trajectory_->v(at[i]);
      a_[i] = accelerations && moves() ? trajectory_->a(at[i]) : 0.0;
    }
  }

  /// All coordinates of the motion, moved to, in the units of the model.
  void take_state() {
    const std::size_t n = built_.q.size();
    const auto scaled = [&](const std::vector<double>& values) {
      return built_.model->from_si({values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n)});
    };
    state_ = {scaled(q_), scaled(v_), scaled(a_)};
  }

  /// The change of that state by column c.
  MovingState change_by(std::size_t k, std::size_t c) const {
    std::vector<double> q, v, a;
    for (const std::size_t i : places_[k]) {
      q.push_back(trajectory_->q_p(i)[c] + beyond_ * trajectory_->v_p(i)[c]);
      v.push_back(trajectory_->v_p(i)[c]);
      a.push_back(moves() ? trajectory_->a_p(i)[c] : 0.0);
    }
    const MotionModel& model = *built_.model;
    return {model.from_si(q), model.from_si(v), model.from_si(a)};
  }

  /// Beyond its ends the motion goes on at constant rates, and before a start at rest it stands.
  bool moves() const { return !still_ && beyond_ == 0; }

  void add_motion(std::size_t k) {
    const SensorReader::Derivatives& by = readers_[k]->derivatives();
    for (std::size_t i = 0; i < places_[k].size(); ++i) {
      const std::span<const double> q_p = trajectory_->q_p(places_[k][i]);
      const std::span<const double> v_p = trajectory_->v_p(places_[k][i]);
      const double on_q = by.by_q[i];
      const double on_v = by.by_v[i] + by.by_q[i] * beyond_;
      for (std::size_t c = 0; c < column_.size(); ++c) column_[c] += on_q * q_p[c];
      if (on_v != 0) {
        for (std::size_t c = 0; c < column_.size(); ++c) column_[c] += on_v * v_p[c];
      }
      if (by.by_a[i] == 0 || !moves()) continue;
      const std::span<const double> a_p = trajectory_->a_p(places_[k][i]);
      for (std::size_t c = 0; c < column_.size(); ++c) column_[c] += by.by_a[i] * a_p[c];
    }
  }

  void add_law(std::size_t k, double* numbers) {
    const auto by = [&](const SceneParameter& number) {
      return number.force_by(built_.model->scene(), run_.experiment_.sensors[k].element, readers_[k]->measure(), 0.0);
    };
    for (const SceneParameter& number : run_.numbers_) *numbers++ += by(number);
    if (run_.set_by_equilibrium_) *numbers += by(*run_.set_by_equilibrium_);
  }

  const RunModel& run_;
  const Built& built_;
  double duration_;
  std::vector<std::optional<SensorReader>> readers_;       // none of a sensor that is not read in this run
  std::vector<std::optional<VariedQuantity>> quantities_;  // of those that read one
  MovingState state_;                                      // of the last of these
  std::vector<std::vector<std::size_t>> places_;           // of each sensor's coordinates in these
  std::vector<int> coordinates_;
  std::vector<std::vector<VariedReader>> varied_;  // per sensor
  std::optional<TrajectoryReader> trajectory_;
  double now_ = -INFINITY;
  double beyond_ = 0.0;  // time after the end of the motion, or before its start
  bool still_ = false;
  std::vector<double> q_, v_, a_, column_;
};

void RunModel::predict(const double* unknowns, const double* nuisances, double until, double accuracy, bool jacobian,
                       Prediction& out, const std::atomic<bool>* interrupt) const {
  out.ok = false;
  const std::vector<Scaling> scaling = scalings(unknowns);
  for (const SensorNumber& number : sensor_numbers_) {
    if (scaling[number.sensor].factor != 0) continue;
    out.why = fmt::format("the factor of sensor \"{}\" is 0", experiment_.sensors[number.sensor].name);
    return;
  }
  if (is_at_rest()) return predict_at_rest(unknowns, until, jacobian, out, interrupt);
  const Built built = build(unknowns, equilibrium_unknown_ ? nuisances[0] : equilibrium_at(), jacobian);
  if (!built.model) {
    out.why = built.why;
    return;
  }
  const std::vector<Reading> due = this->due(scaling, until);
  double duration = std::clamp(due.empty() ? 0.0 : due.back().time, 1e-9, std::max(end_, 1e-9));
  Motion motion = move(built, nuisances, duration, accuracy, jacobian, interrupt);
  out.why = lacks_impacts(until, motion);
  for (int longer = 0; longer < most_times_longer && motion.completed() && !out.why.empty(); ++longer) {
    duration *= 1.5;
    motion = move(built, nuisances, duration, accuracy, jacobian, interrupt);
    out.why = lacks_impacts(until, motion);
  }
  if (!motion.completed()) out.why = motion.why;
  if (!out.why.empty()) return;
  std::vector<ImpactsRead> impacts;
  for (const Sensor& sensor : experiment_.sensors) impacts.push_back(impacts_at(built.model->scene(), sensor, motion));
  Readings readings(*this, built, motion, duration, jacobian);
  const auto width = static_cast<std::size_t>(columns());
  std::vector<std::size_t> first{0};  // row of each sensor's first reading
  for (const std::size_t count : counts(until)) first.push_back(first.back() + count);
  out.reading.resize(first.back());
  if (jacobian) out.jacobian.assign(out.reading.size() * width, 0.0);
  for (const auto& [time, k, s] : due) {
    const Sensor& sensor = experiment_.sensors[k];
    const Scaling& own = scaling[k];
    const double gain = sensor.unit / own.factor;
    const std::size_t row = first[k] + s;
    const double quantity = sensor.reads_impacts() ? impacts[k].time(s) : readings.read(time, k);
    if (!std::isfinite(quantity)) {
      out.why =
          fmt::format("{} is not determined at {:.6g} s", sensor.quantity ? sensor.quantity->name : sensor.name, time);
      return;
    }
    out.reading[row] = gain * quantity + (sensor.zero - gain * own.zero);
    if (!jacobian) continue;
    const double change = sensor.reads_impacts() ? 0.0 : readings.rate_of_change(k);
    const std::vector<double>& by =
        sensor.reads_impacts() ? readings.derivatives(impacts[k].at(s)) : readings.derivatives(k);
    fill_row(built, k, own, gain, quantity, change, by, &out.jacobian[row * width]);
  }
  out.ok = true;
}

/// A quantity that a sensor reads, with its derivatives by the numbers and the one that an equilibrium sets.
VariedQuantity RunModel::quantity_of(std::size_t sensor, const std::shared_ptr<const MotionModel>& model,
                                     bool derivatives) const {
  constexpr double part = 1e-4;  // of a number's size
  const auto reader = [&](std::shared_ptr<const MotionModel> of) {
    return QuantityReader(std::move(of), *experiment_.sensors[sensor].quantity, inputs_);
  };
  std::vector<VariedQuantity::Number> numbers;
  std::vector<SceneParameter> all = numbers_;
  if (set_by_equilibrium_) all.push_back(*set_by_equilibrium_);
  for (const SceneParameter& number : all) {
    if (!derivatives) break;
    const double value = number.get(model->scene());
    const double step = part * (value != 0 ? std::abs(value) : reach(number));
    const auto can_move = [&](double by) { return number.allows(model->scene(), value + by); };
    VariedQuantity::Number& one = numbers.emplace_back(
        VariedQuantity::Number{can_move(2 * step) ? step : -step, !can_move(2 * step) || !can_move(-2 * step)});
    for (const double steps : one.one_sided ? std::array{1.0, 2.0, 3.0, 4.0} : std::array{1.0, -1.0, 2.0, -2.0}) {
      Scene scene = model->scene();
      number.set(scene, value + steps * one.step);
      one.moved.push_back(reader(std::make_shared<const MotionModel>(std::move(scene), scales_, varying_)));
    }
  }
  return {reader(model), std::move(numbers)};
}

double RunModel::ImpactsRead::time(std::size_t i) const {
  const double last = at(i).t;
  if (i < impacts.size()) return last;
  const double left_out = static_cast<double>(i + 1 - impacts.size());
  return last + (rest->t - last) * (1 - std::pow(ratio, left_out));
}

RunModel::ImpactsRead RunModel::impacts_at(const Scene& scene, const Sensor& sensor, const Motion& motion) {
  ImpactsRead out;
  if (!sensor.reads_impacts()) return out;
  for (const ContactEvent& event : motion.events) {
    if (std::find(sensor.stops.begin(), sensor.stops.end(), event.at.stop) == sensor.stops.end()) continue;
    if (event.kind == ContactEvent::Kind::rest) {
      out.rest = &event;
      out.ratio = scene.stops[static_cast<std::size_t>(event.at.stop)].rebound();
      break;
    }
    if (event.kind != ContactEvent::Kind::impact) continue;
    if (out.impacts.empty() || out.impacts.back()->t != event.t) out.impacts.push_back(&event);
  }
  return out;
}

std::string RunModel::lacks_impacts(double until, const Motion& motion) const {
  const std::vector<std::size_t> wanted = counts(until);
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const Sensor& sensor = experiment_.sensors[k];
    const ImpactsRead found = impacts_at(scene_, sensor, motion);
    if (sensor.reads_impacts() && !found.has(wanted[k])) {
      return fmt::format("sensor \"{}\" read {} impacts, the motion has {}", sensor.name, wanted[k],
                         found.impacts.size());
    }
  }
  return "";
}

/// The derivatives of a reading of sensor k by the unknowns and nuisances, from those of its quantity.
void RunModel::fill_row(const Built& built, std::size_t k, const Scaling& own, double gain, double quantity,
                        double change, const std::vector<double>& by, double* to) const {
  const double* numbers = by.data() + 2 * freedoms_;
  const double by_set = set_by_equilibrium_ ? numbers[numbers_.size()] : 0.0;
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    *to++ = gain * (numbers[i] + (set_by_equilibrium_ ? by_set * built.set_by[i] : 0.0));
  }
  for (const SensorNumber& number : sensor_numbers_) {
    const double of_quantity = number.of == SensorNumber::Of::zero     ? -1.0
                               : number.of == SensorNumber::Of::factor ? (own.zero - quantity) / own.factor
                                                                       : -change;
    *to++ = number.sensor == k ? gain * of_quantity : 0.0;
  }
  if (equilibrium_unknown_) *to++ = gain * by_set * built.set_by_at;
  if (!start_unknown_) return;
  std::transform(by.begin(), by.begin() + 2 * freedoms_, to, [&](double one) { return gain * one; });
}

}  // namespace poise
