#include "identification/prediction/private/sensor_reader.hpp"

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

SensorReader::SensorReader(const ScaledModel& model, const Sensor& sensor)
    : phasors_(layout_in_si(model), true),
      on_(model.scene(), layout_in_si(model), phasors_, measure_of(model.scene(), sensor)),
      rate_(sensor.rate),
      impacts_(sensor.reads_impacts()),
      q_(static_cast<std::size_t>(phasors_.coordinates()), 0.0),
      v_(q_),
      bent_(q_),
      pose_(static_cast<std::size_t>(phasors_.pose_size() + on_.scratch_size())) {
  if (sensor.reads_force()) law_ = model.scene().elements[static_cast<std::size_t>(sensor.element)].law;
}

double SensorReader::read(const double* q, const double* v, double* by_q, double* by_v) {
  const std::vector<int>& support = on_.support();
  for (std::size_t i = 0; i < support.size(); ++i) {
    q_[static_cast<std::size_t>(support[i])] = q[i];
    v_[static_cast<std::size_t>(support[i])] = v[i];
    by_q[i] = by_v[i] = 0.0;
  }
  if (impacts_) return 0.0;
  phasors_.place_some(q_.data(), support, !on_.is_linear(), pose_.data());
  const Configuration<double> here{phasors_, pose_.data(), pose_.data() + phasors_.pose_size()};
  measure_ = on_.value(here);
  if (rate_) {
    for (const int t : support) bent_[static_cast<std::size_t>(t)] = 0.0;
    on_.add_bend(here, v_.data(), 1.0, bent_.data());
    on_.gradient(here, [&](int i, double by) { by_v[i] = by; });
    double rate = 0.0;
    for (std::size_t i = 0; i < support.size(); ++i) {
      rate += by_v[i] * v[i];
      by_q[i] = bent_[static_cast<std::size_t>(support[i])];
    }
    return rate;
  }
  const LawForce<double> force = law_ ? force_at_rest(*law_, measure_) : LawForce<double>{measure_, 1.0, 0.0};
  on_.gradient(here, [&](int i, double by) { by_q[i] = force.by_measure * by; });
  return force.value;
}

SensorVariation::SensorVariation(const Variation& variation, const Sensor& sensor)
    : along_(variation.model().scene(), variation.number(), Scales{}),
      phasors_(phasors_along(layout_in_si(variation.model()), along_.numbers())),
      on_(along_.scene(), layout_in_si(variation.model()), phasors_, measure_of(along_.scene(), sensor)),
      rate_(sensor.rate),
      q_(static_cast<std::size_t>(phasors_.coordinates())),
      v_(q_),
      pose_(static_cast<std::size_t>(phasors_.pose_size() + on_.scratch_size())) {
  if (sensor.reads_impacts()) {
    acts_ = false;
    return;
  }
  if (!sensor.reads_force()) {
    // The derivative of an angle or a travel is one number.
    const std::vector<double> none(on_.support().size(), 0.0);
    acts_ = !on_.is_linear() || read(none.data(), none.data()) != 0.0;
    return;
  }
  on_.set_terms(along_.numbers(), measure_of(along_.scene(), sensor), -1);
  along_.numbers().with_law(sensor.element, [&](const auto& law) { law_ = law; });
}

double SensorVariation::read(const double* q, const double* v) {
  if (!acts_) return 0.0;
  const std::vector<int>& support = on_.support();
  for (std::size_t i = 0; i < support.size(); ++i) {
    q_[static_cast<std::size_t>(support[i])] = Dual(q[i]);
    v_[static_cast<std::size_t>(support[i])] = Dual(v[i]);
  }
  phasors_.place_some(q_.data(), support, !on_.is_linear(), pose_.data());
  const Configuration<Dual> here{phasors_, pose_.data(), pose_.data() + phasors_.pose_size()};
  if (rate_) return on_.along(here, v_.data()).v[0];
  const Dual measure = on_.value(here);
  return (law_ ? force_at_rest(*law_, measure).value : measure).v[0];
}

}  // namespace poise
