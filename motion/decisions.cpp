#include "motion/decisions.hpp"

#include <cmath>

#include "motion/motion_input_impl.hpp"

namespace poise {
namespace {

VariedModel::Dual dual(double value, double by) {
  VariedModel::Dual out(value);
  out.v[0] = by;
  return out;
}

}  // namespace

Decisions::Decisions(const MotionModel& model, const std::vector<Variation>& variations,
                     const std::vector<Influence>& influences)
    : model_(model),
      variations_(variations),
      influences_(influences),
      pose_(static_cast<std::size_t>(model.mechanism().pose_size())) {}

void Decisions::change(ReducedMotion<double>& motion, double t, std::span<const int> elements,
                       const std::vector<double>& dq, const std::vector<double>& dv, int influence, const Use& use) {
  const Influence* const by = influence < 0 ? nullptr : &influences_[static_cast<std::size_t>(influence)];
  const VariedModel* const varied =
      by != nullptr && by->variation >= 0 ? &variations_[static_cast<std::size_t>(by->variation)].compiled() : nullptr;
  std::vector<double> v(motion.v(), motion.v() + motion.coordinates()), change = dv;
  std::vector<double> reactions_by;
  if (motion.reads_reactions()) reactions_by = motion.reactions_along(dq.data(), dv.data(), by);
  if (varied != nullptr) {
    const Mechanism<Dual>& m = varied->mechanism();
    InputForces<Dual> forces(m);
    forces.set_inputs(varied->numbers(), motion.inputs());
    forces.set(t, std::isnan(motion.near()) ? t : motion.near());
    std::vector<Dual> q, rates;
    for (std::size_t i = 0; i < dq.size(); ++i) q.push_back(dual(motion.q()[i], dq[i]));
    std::vector<Planar<Dual>> pose(static_cast<std::size_t>(m.pose_size()));
    m.place(q.data(), pose.data());
    std::vector<Dual> reactions;
    for (std::size_t e = 0; e < reactions_by.size(); ++e) {
      reactions.push_back(dual(motion.forces_in_time().reactions[e], reactions_by[e]));
    }
    if (!reactions.empty()) forces.set_reactions(reactions.data());
    const ForcesInTime<Dual> in_time = forces.in_time();
    for (std::size_t k = 0; k < elements.size(); ++k) {
      rates.clear();
      for (std::size_t i = 0; i < v.size(); ++i) rates.push_back(dual(v[i], change[i]));
      const auto& law = *controller_of(law_in_time(m, in_time, elements[k]));
      const std::array<Dual, 3> decided =
          in_si(law.decide(m.signals_of(elements[k], pose.data(), rates.data(), in_time)), law.effort_unit);
      use(k, {{decided[0].a, decided[1].a, decided[2].a}, {decided[0].v[0], decided[1].v[0], decided[2].v[0]}}, v,
          change);
    }
    return;
  }
  const Mechanism<double>& m = model_.mechanism();
  m.place(motion.q(), pose_.data());
  const ForcesInTime<double> in_time = motion.forces_in_time();
  const bool is_of_controller = by != nullptr && by->body < 0 && by->drive < 0 &&
                                by->force.of == ForceNumber::Of::element && m.is_of_control(by->force.item);
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const int element = elements[k];
    ControlChange<double> along{.dq = dq.data(), .dv = change.data()};
    if (!reactions_by.empty()) along.reactions = reactions_by.data();
    if (is_of_controller) {
      along.element = by->force.item;
      along.number = by->force.number;
      along.by = by->by * motion.number_of_element_by(by->force);
    }
    const Controller& law = *controller_of(law_in_time(m, in_time, element));
    const ControlSignals<double> in = m.signals_of(element, pose_.data(), v.data(), in_time);
    const ControlSignals<double> in_by = m.signals_along(element, pose_.data(), v.data(), along, in_time);
    Decided decided{in_si(law.decide(in), law.effort_unit), in_si(law.decide_along(in, in_by), law.effort_unit)};
    if (along.element == element) {
      const std::array<double, 3> own = in_si(law.decide_by(along.number, in), law.effort_unit);
      for (std::size_t i = 0; i < own.size(); ++i) decided.by[i] += along.by * own[i];
    }
    use(k, decided, v, change);
  }
}

}  // namespace poise
