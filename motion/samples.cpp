#include "motion/samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/controllers.hpp"
#include "motion/motion_input_impl.hpp"

namespace poise {
namespace {

/// What is held, in SI.
template <class T>
std::array<T, 3> held_of(const ControlOutputs<T>& decided, double effort_unit) {
  return {decided.effort * (1.0 / effort_unit), decided.integral, decided.input};
}

}  // namespace

Samples::Samples(const MotionModel& model, const std::vector<Variation>& variations,
                 const std::vector<Influence>& influences)
    : model_(model), variations_(variations), influences_(influences) {
  const Scene& scene = model.scene();
  for (const int e : in_order_of_decisions(scene)) {
    const Element& element = scene.elements[static_cast<std::size_t>(e)];
    const Controller& law = *controller_of(element.law);
    if (!law.has(Controller::period)) continue;
    One one{e, law.values[Controller::period], {}};
    for (const int body : element.feedback->held) {
      one.held.push_back(body < 0 ? -1 : model.layout().links[static_cast<std::size_t>(body)].frame);
    }
    sampled_.push_back(std::move(one));
  }
  pose_.resize(static_cast<std::size_t>(model.mechanism().pose_size()));
}

double Samples::next(double t, double apart) const {
  double out = std::numeric_limits<double>::infinity();
  for (const One& one : sampled_) {
    out = std::min(out, (std::floor((t + apart) / one.period) + 1) * one.period);
  }
  return out;
}

bool Samples::is_at(const One& one, double t, double apart) const {
  return std::abs(t - std::round(t / one.period) * one.period) <= apart;
}

bool Samples::are_at(double t, double apart) const {
  return std::any_of(sampled_.begin(), sampled_.end(), [&](const One& one) { return is_at(one, t, apart); });
}

// Where controllers with states depend on each other in a circle, the second round knows what all have decided.
template <class Use>
void Samples::for_each_decided(double t, double apart, const Use& use) const {
  for (int round = 0; round < 2; ++round) {
    for (const One& one : sampled_) {
      if (is_at(one, t, apart)) use(one);
    }
  }
}

std::vector<Samples::Held> Samples::take(const ReducedMotion<double>& motion, double t, double apart) {
  const Mechanism<double>& m = model_.mechanism();
  m.place(motion.q(), pose_.data());
  std::vector<double> v(motion.v(), motion.v() + motion.coordinates());
  const ForcesInTime<double> in_time = motion.forces_in_time();
  for_each_decided(t, apart, [&](const One& one) {
    const Controller& law = *controller_of(law_in_time(m, in_time, one.element));
    const std::array<double, 3> held =
        held_of(law.decide(m.signals_of(one.element, pose_.data(), v.data(), in_time)), law.effort_unit);
    for (std::size_t k = 0; k < held.size(); ++k) {
      if (one.held[k] >= 0) v[static_cast<std::size_t>(one.held[k])] = held[k];
    }
  });
  std::vector<Held> out;
  for (const One& one : sampled_) {
    for (const int i : one.held) {
      if (i >= 0 && is_at(one, t, apart)) out.push_back({i, v[static_cast<std::size_t>(i)]});
    }
  }
  return out;
}

std::vector<Samples::Held> Samples::take_by(const ReducedMotion<double>& motion, double t, double apart,
                                            const std::vector<double>& dq, const std::vector<double>& dv,
                                            int influence) {
  const Influence* const by = influence < 0 ? nullptr : &influences_[static_cast<std::size_t>(influence)];
  const VariedModel* const varied =
      by != nullptr && by->variation >= 0 ? &variations_[static_cast<std::size_t>(by->variation)].compiled() : nullptr;
  std::vector<double> v(motion.v(), motion.v() + motion.coordinates()), change = dv;
  const auto set = [&](const One& one, const std::array<double, 3>& held, const std::array<double, 3>& slope) {
    for (std::size_t k = 0; k < held.size(); ++k) {
      if (one.held[k] < 0) continue;
      v[static_cast<std::size_t>(one.held[k])] = held[k];
      change[static_cast<std::size_t>(one.held[k])] = slope[k];
    }
  };
  if (varied != nullptr) {
    const Mechanism<Dual>& m = varied->mechanism();
    InputForces<Dual> forces(m);
    forces.set_inputs(varied->numbers(), motion.inputs());
    forces.set(t, std::isnan(motion.near()) ? t : motion.near());
    std::vector<Dual> q, rates;
    for (std::size_t i = 0; i < dq.size(); ++i) q.emplace_back(motion.q()[i], dq[i]);
    std::vector<Planar<Dual>> pose(static_cast<std::size_t>(m.pose_size()));
    m.place(q.data(), pose.data());
    const ForcesInTime<Dual> in_time = forces.in_time();
    for_each_decided(t, apart, [&](const One& one) {
      rates.clear();
      for (std::size_t i = 0; i < v.size(); ++i) rates.emplace_back(v[i], change[i]);
      const auto& law = *controller_of(law_in_time(m, in_time, one.element));
      const std::array<Dual, 3> held =
          held_of(law.decide(m.signals_of(one.element, pose.data(), rates.data(), in_time)), law.effort_unit);
      set(one, {held[0].a, held[1].a, held[2].a}, {held[0].v[0], held[1].v[0], held[2].v[0]});
    });
  } else {
    const Mechanism<double>& m = model_.mechanism();
    m.place(motion.q(), pose_.data());
    const ForcesInTime<double> in_time = motion.forces_in_time();
    ControlChange<double> along{.dq = dq.data(), .dv = change.data()};
    const bool is_of_controller = by != nullptr && by->body < 0 && by->drive < 0 &&
                                  by->force.of == ForceNumber::Of::element && m.is_of_control(by->force.item);
    if (is_of_controller) {
      along.element = by->force.item;
      along.number = by->force.number;
      along.by = by->by * motion.number_of_element_by(by->force);
    }
    for_each_decided(t, apart, [&](const One& one) {
      const Controller& law = *controller_of(law_in_time(m, in_time, one.element));
      const ControlSignals<double> in = m.signals_of(one.element, pose_.data(), v.data(), in_time);
      const ControlSignals<double> in_by = m.signals_along(one.element, pose_.data(), v.data(), along, in_time);
      const std::array<double, 3> held = held_of(law.decide(in), law.effort_unit);
      std::array<double, 3> slope = held_of(law.decide_along(in, in_by), law.effort_unit);
      if (along.element == one.element) {
        const std::array<double, 3> own = held_of(law.decide_by(along.number, in), law.effort_unit);
        for (std::size_t k = 0; k < slope.size(); ++k) slope[k] += along.by * own[k];
      }
      set(one, held, slope);
    });
  }
  std::vector<Held> out;
  for (const One& one : sampled_) {
    for (const int i : one.held) {
      if (i >= 0 && is_at(one, t, apart)) out.push_back({i, change[static_cast<std::size_t>(i)]});
    }
  }
  return out;
}

}  // namespace poise
