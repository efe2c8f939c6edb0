#include "identification/prediction/private/sensor_reader.hpp"

namespace poise {
namespace {

Layout layout_in_si(const ScaledModel& model) {
  Layout layout = model.layout();
  layout.scale_lengths(model.scales().length);
  return layout;
}

}  // namespace

SensorReader::SensorReader(const ScaledModel& model, const Sensor& sensor)
    : phasors_(layout_in_si(model), true),
      // Of an element, whose measure may have a factor that varies.
      on_(model.scene(), layout_in_si(model), phasors_,
          sensor.reads_force() ? model.scene().elements[static_cast<std::size_t>(sensor.element)].on : sensor.on),
      rate_(sensor.rate),
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

}  // namespace poise
