#pragma once

// Members of Mechanism for motion; the others are in model/mechanism_impl.hpp.

#include <algorithm>

#include "model/mechanism.hpp"

namespace poise {

template <class T>
void Mechanism<T>::closures_of(const Planar<T>* f, T* c) const {
  for (int l = 0; l < closures(); ++l) {
    Planar<T> sum{};
    for (int e = closure_first_[l]; e < closure_first_[l + 1]; ++e) {
      sum += closure_coefficient_[e] * f[closure_coordinate_[e]];
    }
    c[closure_row_[l]] = sum.x;
    c[closure_row_[l] + 1] = sum.y;
  }
}

template <class T>
void Mechanism<T>::resist(Planar<T>* pose, const T* v, const int* slides, T* resistances,
                          const ForcesInTime<T>& in_time) const {
  const Configuration<T> here = at(pose);
  for (const int r : resisting_) {
    const ForceElement& e = elements_[r];
    const std::vector<int>& support = e.on.support();
    T* slopes = resistances + 3;
    std::fill(slopes, slopes + support.size(), T(0));
    T w(0);
    // Motions of few forces take a tenth longer where the compiler does not inline this.
    e.on.gradient(
        here, [&](int i, const T& by) __attribute__((always_inline)) {
          slopes[i] = by;
          w += by * v[support[i]];
        });
    const LawIn<T>& law = in_time.laws != nullptr && in_time.laws[r] != nullptr ? *in_time.laws[r] : e.law;
    const LawForce<T> force = slides != nullptr && sticks(law) ? force_of_sliding(law, slides[r], w)
                                                               : force_of_motion(law, e.on.value(here), w);
    resistances[0] = force.value;
    resistances[1] = force.by_measure;
    resistances[2] = force.by_rate;
    resistances = slopes + support.size();
  }
  for (const Control& control : controls_) {
    const std::vector<int>& support = pushed(control);
    T* slopes = resistances + 3;
    std::fill(slopes, slopes + support.size(), T(0));
    slopes_of_push(control, here, slopes);
    const ControlOutputs<T> out = outputs(control, here, v, in_time, true);
    resistances[0] = effort_by(control, out.effort, here, v, in_time);
    resistances[1] = out.integral;
    resistances[2] = out.filtered;
    resistances = slopes + support.size();
  }
}

template <class T>
const typename Mechanism<T>::Control& Mechanism<T>::control_of(int element) const {
  return *std::find_if(controls_.begin(), controls_.end(), [&](const Control& one) { return one.element == element; });
}

template <class T>
ControlSignals<T> Mechanism<T>::own_signals(const Control& control, const Configuration<T>& here, const T* v) const {
  const ControllerOf<NumberOfLaw<T>>& law = *controller_of(elements_[control.element].law);
  ControlSignals<T> out;
  const T rate = control.reads.along(here, v);
  out.value = law.of_rate ? rate : control.reads.value(here);
  out.rate = law.of_rate ? T(0) : rate;
  out.integral = control.integral.along(here, v);
  out.place = control.filter.value(here);
  out.filtered = control.filter.along(here, v);
  if (law.holds()) {
    out.held_effort = control.held[0].along(here, v);
    out.held_integral = control.held[1].along(here, v);
    out.held_input = control.held[2].along(here, v);
  }
  return out;
}

template <class T>
ControlSignals<T> Mechanism<T>::own_signals_along(const Control& control, const Configuration<T>& here, const T* v,
                                                  const T* dq, const T* dv) const {
  const ControllerOf<NumberOfLaw<T>>& law = *controller_of(elements_[control.element].law);
  ControlSignals<T> out;
  const T rate = control.reads.second(here, v, dq) + control.reads.along(here, dv);
  out.value = law.of_rate ? rate : control.reads.along(here, dq);
  out.rate = law.of_rate ? T(0) : rate;
  out.integral = control.integral.along(here, dv);
  out.place = control.filter.along(here, dq);
  out.filtered = control.filter.along(here, dv);
  if (law.holds()) {
    out.held_effort = control.held[0].along(here, dv);
    out.held_integral = control.held[1].along(here, dv);
    out.held_input = control.held[2].along(here, dv);
  }
  return out;
}

template <class T>
ControlSignals<T> Mechanism<T>::signals(const Control& control, const Configuration<T>& here, const T* v,
                                        const ForcesInTime<T>& in_time, bool all) const {
  ControlSignals<T> out = own_signals(control, here, v);
  if (!control.is_behind_others() || (!all && !law_at(control, in_time).is_direct())) return out;
  const auto effort_of = [&](int element) { return outputs(control_of(element), here, v, in_time, false).effort; };
  if (control.follows >= 0) out.followed = effort_of(control.follows);
  if (control.reads_from >= 0) out.value = effort_of(control.reads_from);
  if (control.reads_force >= 0) out.value = read_force(control, here, v, in_time).value;
  if (control.reads_reaction && in_time.reactions != nullptr) out.value = in_time.reactions[control.element];
  return out;
}

template <class T>
ControlOutputs<T> Mechanism<T>::outputs(const Control& control, const Configuration<T>& here, const T* v,
                                        const ForcesInTime<T>& in_time, bool all) const {
  return law_at(control, in_time).respond(signals(control, here, v, in_time, all));
}

template <class T>
ControlSignals<T> Mechanism<T>::signals_along(const Control& control, const Configuration<T>& here, const T* v,
                                              const ControlChange<T>& change, const ForcesInTime<T>& in_time,
                                              bool all) const {
  const ControllerOf<NumberOfLaw<T>>& law = law_at(control, in_time);
  ControlSignals<T> out;
  if (change.dv != nullptr) out = own_signals_along(control, here, v, change.dq, change.dv);
  if (!control.is_behind_others() || (!all && !law.is_direct())) return out;
  const auto change_of = [&](int element) {
    return outputs_along(control_of(element), here, v, change, in_time, false).effort;
  };
  if (control.follows >= 0) out.followed = change_of(control.follows);
  if (control.reads_from >= 0) out.value = change_of(control.reads_from);
  if (control.reads_reaction && change.reactions != nullptr) out.value = change.reactions[control.element];
  if (control.reads_force >= 0) {
    const ForceElement& e = elements_[control.reads_force];
    const LawForce<T> force = read_force(control, here, v, in_time);
    if (change.dv != nullptr) {
      const T rate = e.on.second(here, v, change.dq) + e.on.along(here, change.dv);
      out.value = force.by_measure * e.on.along(here, change.dq) + force.by_rate * rate;
    }
    if (change.element == control.reads_force) {
      out.value += change.by * force_by_number_there(change.element, change.number, here, v, in_time);
    }
    if (control.force_set_by >= 0) {
      const int number = control_of(control.force_set_by).sets;
      out.value +=
          change_of(control.force_set_by) * force_by_number_there(control.reads_force, number, here, v, in_time);
    }
  }
  return out;
}

template <class T>
ControlOutputs<T> Mechanism<T>::outputs_along(const Control& control, const Configuration<T>& here, const T* v,
                                              const ControlChange<T>& change, const ForcesInTime<T>& in_time,
                                              bool all) const {
  const ControllerOf<NumberOfLaw<T>>& law = law_at(control, in_time);
  const ControlSignals<T> in = signals(control, here, v, in_time, all);
  ControlOutputs<T> out = law.respond_along(in, signals_along(control, here, v, change, in_time, all));
  if (change.element != control.element) return out;
  const ControlOutputs<T> by = law.respond_by(change.number, in);
  out.effort += change.by * by.effort;
  out.integral += change.by * by.integral;
  out.filtered += change.by * by.filtered;
  return out;
}

template <class T>
void Mechanism<T>::slopes_of_push(const Control& control, const Configuration<T>& here, T* slopes) const {
  if (control.on >= 0) {
    elements_[control.on].on.gradient(here, [&](int i, const T& by) { slopes[i] = by; });
  } else if (control.load >= 0) {
    const LoadAt& load = loads_[control.load];
    const Planar<T> direction = world_force(load.direction, load.frame, here.pose);
    load.path.derivative(phasors_, here.pose, here.scratch);
    for (int i = 0; i < load.path.size(); ++i) slopes[i] = dot(direction, here.scratch[i]);
  } else {
    std::fill(slopes, slopes + control.turns.size(), control.turned_by);
  }
}

template <class T>
void Mechanism<T>::add_bend_of_push(const Control& control, const Configuration<T>& here, const T* dq, const T& effort,
                                    T* g) const {
  if (control.on >= 0) {
    const CompiledMeasure<T>& on = elements_[control.on].on;
    if (!on.is_linear()) on.add_bend(here, dq, T(-effort), g);
    return;
  }
  if (control.load < 0) return;
  const LoadAt& load = loads_[control.load];
  const std::vector<int>& support = load.path.support();
  const Planar<T> force = effort * world_force(load.direction, load.frame, here.pose);
  load.path.bend(
      phasors_, here.pose, dq, [&](const Planar<T>& along) { return dot(force, along); },
      [&](int i, const T& change) { g[support[i]] -= change; });
  if (load.frame < 0) return;
  const Planar<T> turned = dq[load.frame] * quarter_turn(force);
  load.path.derivative(phasors_, here.pose, here.scratch);
  for (int i = 0; i < load.path.size(); ++i) g[support[i]] -= dot(turned, here.scratch[i]);
}

// What a controller adds to the number that it sets.
template <class T>
T Mechanism<T>::more_by_setting(int controller, const Configuration<T>& here, const T* v,
                                const ForcesInTime<T>& in_time) const {
  return outputs(control_of(controller), here, v, in_time, false).effort;
}

// A controller that sets a number pushes by the force that its element lacks then.
template <class T>
T Mechanism<T>::effort_by(const Control& control, const T& output, const Configuration<T>& here, const T* v,
                          const ForcesInTime<T>& in_time) const {
  if (control.sets < 0) return output;
  const CompiledMeasure<T>& on = elements_[control.on].on;
  const T g = on.value(here), w = on.along(here, v);
  const LawIn<T>& law = law_in_time(*this, in_time, control.on);
  const auto force = [&](const auto& one) { return whole_force(one, g, w).value; };
  return with_more(law, control.sets, T(0), force) - with_more(law, control.sets, output, force);
}

template <class T>
T Mechanism<T>::effort_along(const Control& control, const T& output, const T& change, const Configuration<T>& here,
                             const T* v, const ControlChange<T>& along, const ForcesInTime<T>& in_time) const {
  if (control.sets < 0) return change;
  const CompiledMeasure<T>& on = elements_[control.on].on;
  const T g = on.value(here), w = on.along(here, v);
  const LawIn<T>& law = law_in_time(*this, in_time, control.on);
  T out =
      -change * with_more(law, control.sets, output, [&](const auto& one) { return one.force_by(control.sets, g, w); });
  if (along.dv == nullptr) return out;
  const auto force = [&](const auto& one) { return whole_force(one, g, w); };
  const LawForce<T> with = with_more(law, control.sets, output, force);
  const LawForce<T> without = with_more(law, control.sets, T(0), force);
  out -= (with.by_measure - without.by_measure) * on.along(here, along.dq);
  out -= (with.by_rate - without.by_rate) * (on.second(here, v, along.dq) + on.along(here, along.dv));
  return out;
}

template <class T>
LawForce<T> Mechanism<T>::read_force(const Control& control, const Configuration<T>& here, const T* v,
                                     const ForcesInTime<T>& in_time) const {
  const CompiledMeasure<T>& on = elements_[control.reads_force].on;
  const T g = on.value(here), w = on.along(here, v);
  const LawIn<T>& law = law_in_time(*this, in_time, control.reads_force);
  if (control.force_set_by < 0) return std::visit([&](const auto& one) { return whole_force(one, g, w); }, law);
  return with_more(law, control_of(control.force_set_by).sets, more_by_setting(control.force_set_by, here, v, in_time),
                   [&](const auto& one) { return whole_force(one, g, w); });
}

// The derivative of the force of an element, of one that a controller sets with what that adds.
template <class T>
T Mechanism<T>::force_by_number_there(int element, int number, const Configuration<T>& here, const T* v,
                                      const ForcesInTime<T>& in_time) const {
  const CompiledMeasure<T>& on = elements_[element].on;
  const T g = on.value(here), w = on.along(here, v);
  const LawIn<T>& law = law_in_time(*this, in_time, element);
  for (const Control& control : controls_) {
    if (control.on != element || control.sets < 0) continue;
    return with_more(law, control.sets, more_by_setting(control.element, here, v, in_time),
                     [&](const auto& one) { return one.force_by(number, g, w); });
  }
  return force_by_number(law, number, g, w);
}

template <class T>
bool Mechanism<T>::is_of_control(int element) const {
  return is_controller(element) || std::any_of(controls_.begin(), controls_.end(), [&](const Control& one) {
           return one.reads_force == element || (one.sets >= 0 && one.on == element);
         });
}

// The torques that give the states these accelerations.
template <class T>
void Mechanism<T>::add_states(const Control& control, const T& integral, const T& filtered, T* g) {
  for (const int i : control.integral.support()) g[i] -= control.inertia * integral;
  for (const int i : control.filter.support()) g[i] -= control.inertia * filtered;
}

template <class T>
void Mechanism<T>::add_change_of_read(const T* reactions, Planar<T>* pose, const T* v, const ForcesInTime<T>& in_time,
                                      T* g) const {
  for (const Control& control : controls_) {
    if (!control.reads_reaction) continue;
    const ControlOutputs<T> out = outputs_along(control, at(pose), v, {.reactions = reactions}, in_time, true);
    add_states(control, out.integral, out.filtered, g);
  }
}

template <class T>
void Mechanism<T>::add_control_derivative(const ControlChange<T>& change, Planar<T>* pose, const T* v,
                                          const ForcesInTime<T>& in_time, T* g) const {
  const Configuration<T> here = at(pose);
  if (!is_controller(change.element)) {
    const T slope = force_by_number_there(change.element, change.number, here, v, in_time);
    elements_[change.element].on.add_gradient(here, change.by * slope, g);
  }
  for (const Control& control : controls_) {
    if (control.element != change.element && !control.is_behind_others()) continue;
    const ControlOutputs<T> out = outputs_along(control, here, v, change, in_time, true);
    add_push(control, out.effort, here, v, in_time, g);
    add_states(control, out.integral, out.filtered, g);
  }
}

template <class T>
void Mechanism<T>::add_push(const Control& control, const T& change, const Configuration<T>& here, const T* v,
                            const ForcesInTime<T>& in_time, T* g) const {
  const T output = control.sets < 0 ? T(0) : outputs(control, here, v, in_time, true).effort;
  const T effort = effort_along(control, output, change, here, v, {}, in_time);
  if (control.on >= 0) {
    elements_[control.on].on.add_gradient(here, T(-effort), g);
  } else if (control.load >= 0) {
    add_load_at(control.load, effort, here, g);
  } else {
    for (const int i : control.turns) g[i] -= effort * control.turned_by;
  }
}

template <class T>
void Mechanism<T>::add_load_at(int load, const T& size, const Configuration<T>& here, T* g) const {
  const LoadAt& at = loads_[load];
  const Planar<T> direction = world_force(at.direction, at.frame, here.pose);
  at.path.derivative(phasors_, here.pose, here.scratch);
  for (int i = 0; i < at.path.size(); ++i) g[at.path.support()[i]] -= size * dot(direction, here.scratch[i]);
}

template <class T>
void Mechanism<T>::add_resistance(const T* resistances, T* g) const {
  for (const int r : resisting_) {
    const std::vector<int>& support = elements_[r].on.support();
    const T* slopes = resistances + 3;
    for (std::size_t i = 0; i < support.size(); ++i) g[support[i]] += resistances[0] * slopes[i];
    resistances = slopes + support.size();
  }
  for (const Control& control : controls_) {
    const std::vector<int>& support = pushed(control);
    const T* slopes = resistances + 3;
    for (std::size_t i = 0; i < support.size(); ++i) g[support[i]] -= resistances[0] * slopes[i];
    add_states(control, resistances[1], resistances[2], g);
    resistances = slopes + support.size();
  }
}

// Of  T(g, w) Dg  with  w = Dg[v]:  (T_g Dg[dq] + T_w (D2g[v, dq] + Dg[dv])) Dg + T D2g[dq, .].
template <class T>
void Mechanism<T>::add_resistance_change(Planar<T>* pose, const T* resistances, const T* v, const T* dq, const T* dv,
                                         T* g, const ForcesInTime<T>& in_time) const {
  const Configuration<T> here = at(pose);
  for (const int r : resisting_) {
    const ForceElement& e = elements_[r];
    const std::vector<int>& support = e.on.support();
    const T* slopes = resistances + 3;
    const bool bends = !e.on.is_linear();
    T w_change = bends ? e.on.second(here, v, dq) : T(0);
    T g_change(0);
    for (std::size_t i = 0; i < support.size(); ++i) {
      w_change += slopes[i] * dv[support[i]];
      g_change += slopes[i] * dq[support[i]];
    }
    const T change = resistances[1] * g_change + resistances[2] * w_change;
    for (std::size_t i = 0; i < support.size(); ++i) g[support[i]] += change * slopes[i];
    if (bends) e.on.add_bend(here, dq, resistances[0], g);
    resistances = slopes + support.size();
  }
  const auto moves = [&](const std::vector<int>& support) {
    return std::any_of(support.begin(), support.end(), [&](int i) { return dq[i] != 0 || dv[i] != 0; });
  };
  const auto knows_change = [&](const Control& control) {
    return control.is_behind_others() || moves(control.reads.support()) || moves(control.integral.support()) ||
           moves(control.filter.support()) ||
           std::any_of(control.held.begin(), control.held.end(),
                       [&](const auto& held) { return moves(held.support()); });
  };
  for (const Control& control : controls_) {
    const std::vector<int>& support = pushed(control);
    const T* slopes = resistances + 3;
    const int frame = control.load < 0 ? -1 : loads_[control.load].frame;
    if (!moves(support) && !knows_change(control) && (frame < 0 || dq[frame] == 0)) {
      resistances = slopes + support.size();
      continue;
    }
    const ControlChange<T> along{.dq = dq, .dv = dv};
    const ControlOutputs<T> change = outputs_along(control, here, v, along, in_time, true);
    const T output = control.sets < 0 ? T(0) : outputs(control, here, v, in_time, true).effort;
    const T effort = effort_along(control, output, change.effort, here, v, along, in_time);
    for (std::size_t i = 0; i < support.size(); ++i) g[support[i]] -= effort * slopes[i];
    add_bend_of_push(control, here, dq, resistances[0], g);
    add_states(control, change.integral, change.filtered, g);
    resistances = slopes + support.size();
  }
}

template <class T>
T Mechanism<T>::follower_power(Planar<T>* pose, const T* v) const {
  T power(0);
  Planar<T>* d_i = at(pose).scratch;
  for (const Follower& f : followers_) {
    f.path.derivative(phasors_, pose, d_i);
    power += dot(world_force(f.force, f.frame, pose), f.path.along(d_i, v));
  }
  return power;
}

template <class T>
void Mechanism<T>::add_force_derivative(const ForceNumber& number, const T& by, Planar<T>* pose, const T* v,
                                        const int* slides, T* g) const {
  const Configuration<T> here = at(pose);
  switch (number.of) {
    case ForceNumber::Of::element: {
      const ForceElement& e = elements_[number.item];
      if (is_of_control(number.item)) {
        add_control_derivative({.element = number.item, .number = number.number, .by = by}, pose, v, {}, g);
        break;
      }
      const T w = e.on.along(here, v);
      const bool directed = slides != nullptr && sticks(e.law);
      const T slope = directed ? force_of_sliding_by_number(e.law, number.number, slides[number.item], w)
                               : force_by_number(e.law, number.number, e.on.value(here), w);
      e.on.add_gradient(here, by * slope, g);
      break;
    }
    case ForceNumber::Of::force: {
      add_load_at(number.item, by, here, g);
      break;
    }
    case ForceNumber::Of::torque:
      if (torque_coordinate_[number.item] >= 0) g[torque_coordinate_[number.item]] -= by;
      break;
    case ForceNumber::Of::frame:  // has numbers of functions of time alone, which add_frame() is told
      break;
  }
}

}  // namespace poise
