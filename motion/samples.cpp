#include "motion/samples.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "model/controllers.hpp"
#include "motion/motion_input_impl.hpp"

namespace poise {

Samples::Samples(const MotionModel& model, const std::vector<Variation>& variations,
                 const std::vector<Influence>& influences)
    : model_(model), decisions_(model, variations, influences) {
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
        in_si(law.decide(m.signals_of(one.element, pose_.data(), v.data(), in_time)), law.effort_unit);
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

std::vector<Samples::Held> Samples::take_by(ReducedMotion<double>& motion, double t, double apart,
                                            const std::vector<double>& dq, const std::vector<double>& dv,
                                            int influence) {
  std::vector<const One*> deciding;
  std::vector<int> elements;
  for_each_decided(t, apart, [&](const One& one) {
    deciding.push_back(&one);
    elements.push_back(one.element);
  });
  std::vector<double> change = dv;
  decisions_.change(
      motion, t, elements, dq, dv, influence,
      [&](std::size_t k, const Decisions::Decided& decided, std::vector<double>& v, std::vector<double>& changed) {
        for (std::size_t h = 0; h < decided.by.size(); ++h) {
          if (deciding[k]->held[h] < 0) continue;
          const auto i = static_cast<std::size_t>(deciding[k]->held[h]);
          v[i] = decided.value[h];
          change[i] = changed[i] = decided.by[h];
        }
      });
  std::vector<Held> out;
  for (const One& one : sampled_) {
    for (const int i : one.held) {
      if (i >= 0 && is_at(one, t, apart)) out.push_back({i, change[static_cast<std::size_t>(i)]});
    }
  }
  return out;
}

}  // namespace poise
