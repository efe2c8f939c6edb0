#include "identification/prediction/private/sensor_reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "model/scene_numbers.hpp"

namespace poise {
namespace {

Layout layout_in_si(const ScaledModel& model) {
  Layout layout = model.layout();
  layout.scale_lengths(model.scales().length);
  return layout;
}

/// What a sensor reads: of an element its measure, whose numbers are those of the scene.
const Measure& measure_of(const Scene& scene, const Sensor& sensor) {
  return sensor.reads_force() ? scene.elements[static_cast<std::size_t>(sensor.element)].on : sensor.on;
}

Phasors<VariedModel::Dual> phasors_along(const Layout& layout, const Numbers<VariedModel::Dual>& numbers) {
  Phasors<VariedModel::Dual> out(layout, true);
  out.set_numbers(numbers);
  return out;
}

}  // namespace

template <class T>
template <class NumbersOfScene>
ReadMeasures<T>::ReadMeasures(const Layout& layout, Phasors<T> phasors, const NumbersOfScene& numbers,
                              const Sensor& sensor)
    : phasors_(std::move(phasors)),
      by_time_(sensor.by_time),
      on_(numbers.scene(), layout, phasors_, measure_of(numbers.scene(), sensor)),
      direction_(sensor.axis.value_or(0.0)),
      gravity_(numbers.gravity()),
      support_(on_.support()) {
  int scratch = on_.scratch_size();
  if (sensor.is_accelerometer()) {
    x_.emplace(numbers.scene(), layout, phasors_, Measure::x_of(sensor.on.b));
    turn_.emplace(numbers.scene(), layout, phasors_, Measure::angle_between(0, sensor.on.b.body));
    for (const CompiledMeasure<T>* const other : {&*x_, &*turn_}) {
      std::vector<int> all;
      std::set_union(support_.begin(), support_.end(), other->support().begin(), other->support().end(),
                     std::back_inserter(all));
      support_ = std::move(all);
      scratch = std::max(scratch, other->scratch_size());
    }
  }
  const auto n = static_cast<std::size_t>(coordinates());
  for (auto* const each : {&q_, &v_, &a_, &unit_}) each->assign(n, T(0));
  pose_.resize(static_cast<std::size_t>(phasors_.pose_size() + scratch));
}

template <class T>
void ReadMeasures<T>::place(const double* q, const double* v, const double* a) {
  for (std::size_t i = 0; i < support_.size(); ++i) {
    const auto at = static_cast<std::size_t>(support_[i]);
    q_[at] = T(q[i]);
    v_[at] = T(v[i]);
    a_[at] = T(a[i]);
  }
  phasors_.place_some(q_.data(), support_, !on_.is_linear(), pose_.data());
}

template <class T>
T ReadMeasures<T>::value() {
  if (x_) {
    axis_ = unit(T(turn_->value(here()) + direction_));
    felt_ = Planar<T>{acceleration(*x_), acceleration(on_)} - gravity_;
    return axis_.x * felt_.x + axis_.y * felt_.y;
  }
  return by_time_ == 0 ? on_.value(here()) : by_time_ == 1 ? on_.along(here(), v_.data()) : acceleration(on_);
}

template <class T>
void ReadMeasures<T>::add_derivatives(T* by_q, T* by_v, T* by_a) {
  if (x_) {
    add_acceleration(*x_, axis_.x, by_q, by_v, by_a);
    add_acceleration(on_, axis_.y, by_q, by_v, by_a);
    turn_->add_gradient(here(), axis_.x * felt_.y - axis_.y * felt_.x, by_q);
  } else if (by_time_ == 0) {
    on_.add_gradient(here(), T(1), by_q);
  } else if (by_time_ == 1) {
    on_.add_bend(here(), v_.data(), T(1), by_q);
    on_.add_gradient(here(), T(1), by_v);
  } else {
    add_acceleration(on_, T(1), by_q, by_v, by_a);
  }
}

template <class T>
void ReadMeasures<T>::add_acceleration(const CompiledMeasure<T>& of, const T& factor, T* by_q, T* by_v, T* by_a) {
  of.add_bend(here(), a_.data(), factor, by_q);
  for (const int i : of.support()) {
    T& one = unit_[static_cast<std::size_t>(i)];
    one = T(1);
    by_q[i] += factor * of.third(here(), v_.data(), v_.data(), unit_.data());
    one = T(0);
  }
  of.add_bend(here(), v_.data(), T(2 * factor), by_v);
  of.add_gradient(here(), factor, by_a);
}

SensorReader::SensorReader(const ScaledModel& model, const Sensor& sensor)
    : read_(layout_in_si(model), Phasors<double>(layout_in_si(model), true), SceneNumbers<double>(model.scene()),
            sensor),
      impacts_(sensor.reads_impacts()),
      by_q_(static_cast<std::size_t>(read_.coordinates()), 0.0),
      by_v_(by_q_),
      by_a_(by_q_) {
  if (sensor.reads_force()) law_ = model.scene().elements[static_cast<std::size_t>(sensor.element)].law;
  for (auto* const each : {&by_.by_q, &by_.by_v, &by_.by_a}) each->resize(coordinates().size());
}

double SensorReader::read(const double* q, const double* v, const double* a) {
  double out = 0.0, slope = 0.0;
  if (!impacts_) {
    read_.place(q, v, a);
    measure_ = read_.measure();
    out = read_.value();
    slope = 1.0;
    read_.add_derivatives(by_q_.data(), by_v_.data(), by_a_.data());
  }
  if (law_) {
    const LawForce<double> force = force_at_rest(*law_, measure_);
    out = force.value;
    slope = force.by_measure;
  }
  const auto take = [&](std::vector<double>& from, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i)
      to[i] = slope * std::exchange(from[static_cast<std::size_t>(coordinates()[i])], 0.0);
  };
  take(by_q_, by_.by_q);
  take(by_v_, by_.by_v);
  take(by_a_, by_.by_a);
  return out;
}

SensorVariation::SensorVariation(const Variation& variation, const Sensor& sensor)
    : along_(variation.model().scene(), variation.number(), Scales{}),
      read_(layout_in_si(variation.model()), phasors_along(layout_in_si(variation.model()), along_.numbers()),
            along_.numbers(), sensor) {
  if (sensor.reads_impacts()) {
    acts_ = false;
    return;
  }
  if (!sensor.reads_force()) {
    // The derivative of an angle or a travel is one number.
    const std::vector<double> none(coordinates().size(), 0.0);
    acts_ = !read_.is_linear() || read(none.data(), none.data(), none.data()) != 0.0;
    return;
  }
  read_.on().set_terms(along_.numbers(), measure_of(along_.scene(), sensor), -1);
  along_.numbers().with_law(sensor.element, [&](const auto& law) { law_ = law; });
}

double SensorVariation::read(const double* q, const double* v, const double* a) {
  if (!acts_) return 0.0;
  read_.place(q, v, a);
  return (law_ ? force_at_rest(*law_, read_.measure()).value : read_.value()).v[0];
}

}  // namespace poise
