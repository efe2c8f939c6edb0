#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "model/scene_numbers.hpp"
#include "motion/motion_input.hpp"

namespace poise {

template <class T>
InputLoad<T>::InputLoad(const Scene& scene, const Mechanism<T>& mechanism, const MotionInput& input)
    : InputLoad(SceneNumbers<T>(scene), mechanism, input) {}

template <class T>
template <class NumbersOfScene>
InputLoad<T>::InputLoad(const NumbersOfScene& numbers, const Mechanism<T>& mechanism, const MotionInput& input)
    : phasors_(mechanism.phasors()), input_(input) {
  const Scene& scene = numbers.scene();
  number_.of = input.of == MotionInput::Of::torque ? ForceNumber::Of::torque : ForceNumber::Of::force;
  number_.item = input.item;
  const Layout& layout = mechanism.layout();
  if (input.of == MotionInput::Of::torque) {
    const Torque& torque = scene.torques[static_cast<std::size_t>(input.item)];
    const int frame = layout.links[static_cast<std::size_t>(torque.body)].frame;
    if (frame < layout.kept) torque_coordinate_ = frame;
    written_ = numbers.torque(input.item);
    return;
  }
  const Force& force = scene.forces[static_cast<std::size_t>(input.item)];
  whole_ = share_at_points(numbers, input.item) * numbers.force(input.item);
  if (force.follows >= 0) {
    const Link& carrier = layout.links[static_cast<std::size_t>(force.follows)];
    whole_ = whole_ * phasors_.turned(carrier.turn);
    frame_ = carrier.frame;
  }
  if (force.has_direction_of_its_own()) {
    const Planar<T> along = numbers.along_force(input.item);
    written_ = dot(numbers.force(input.item), along);
    direction_ = share_at_points(numbers, input.item) * along;
    if (force.follows >= 0) {
      direction_ = direction_ * phasors_.turned(layout.links[static_cast<std::size_t>(force.follows)].turn);
    }
  } else if (!(force.vector == Vec2{})) {
    written_ = norm(numbers.force(input.item));
    direction_ = T(T(1) / written_) * whole_;
  }
  path_ = {phasors_, layout.paths_to(scene, force)};
  derivative_.resize(static_cast<std::size_t>(path_.size()));
}

template <class T>
void InputLoad<T>::add(const Planar<T>* pose, T* g) const {
  if (torque_coordinate_ >= 0) g[torque_coordinate_] -= extra_;
  if (path_.size() == 0) return;
  const Planar<T> force = extra_force(pose);
  path_.derivative(phasors_, pose, derivative_.data());
  for (int i = 0; i < path_.size(); ++i) g[path_.support()[i]] -= dot(force, derivative_[i]);
}

template <class T>
void InputLoad<T>::add_change(const Planar<T>* pose, const T* dq, T* g) const {
  if (path_.size() == 0) return;
  const std::vector<int>& support = path_.support();
  const Planar<T> force = extra_force(pose);
  path_.bend(
      phasors_, pose, dq, [&](const Planar<T>& v) { return dot(force, v); },
      [&](int i, const T& change) { g[support[i]] -= change; });
  if (frame_ < 0) return;
  const Planar<T> turned = dq[frame_] * quarter_turn(force);
  path_.derivative(phasors_, pose, derivative_.data());
  for (int i = 0; i < path_.size(); ++i) g[support[i]] -= dot(turned, derivative_[i]);
}

namespace detail {

/// The numbers of a spring or damper that may follow functions of time, or of the constant force on half the square of
/// a distance that stands for a spring without free length.
template <class N>
std::vector<N> numbers_of_spring(const LawOf<N>& law) {
  return std::visit(
      []<class L>(const L& l) -> std::vector<N> {
        std::vector<N> out;
        if constexpr (VariesInMotion<L>) {
          for (const auto number : L::in_motion) out.push_back(l.*number);
        }
        if constexpr (requires { l.values(); }) out = l.values();
        if constexpr (requires { l.all_values(); }) out = l.all_values();
        return out;
      },
      law);
}

}  // namespace detail

template <class T>
InputSpring<T>::InputSpring(const Mechanism<T>& mechanism, std::vector<MotionInput> inputs)
    : mechanism_(mechanism),
      inputs_(std::move(inputs)),
      written_(detail::numbers_of_spring(mechanism.law_of(element()))),
      values_(written_),
      law_(mechanism.law_of(element())) {}

template <class T>
void InputSpring<T>::set(double t, double near) {
  t_ = t;
  near_ = near;
  set_values([&](const MotionInput& one) { return NumberOfLaw<T>(one.at(t, 0, near)); });
}

template <class T>
template <class Value>
void InputSpring<T>::set_values(Value value) {
  for (const MotionInput& one : inputs_) {
    const auto k = static_cast<std::size_t>(one.number());
    // A free length of zero that is multiplied stays zero.
    if (k < values_.size()) values_[k] = one.multiplies ? value(one) * written_[k] : value(one);
  }
  std::visit([&](auto& law) { law = law.with(values_.data()); }, law_);
}

template <class T>
LawForce<T> InputSpring<T>::extra_force(Planar<T>* pose) const {
  const T g = mechanism_.measure_of(element(), pose);
  const LawForce<T> now = force_at_rest(law_, g), before = force_at_rest(mechanism_.law_of(element()), g);
  return {now.value - before.value, now.by_measure - before.by_measure, T(0)};
}

template <class T>
void InputSpring<T>::add(Planar<T>* pose, T* g) const {
  mechanism_.add_measure_gradient(element(), pose, extra_force(pose).value, g);
}

template <class T>
void InputSpring<T>::add_change(Planar<T>* pose, const T* dq, T* g) const {
  const LawForce<T> extra = extra_force(pose);
  mechanism_.add_measure_change(element(), pose, extra.value, extra.by_measure, dq, g);
}

template <class T>
T InputSpring<T>::by(const ForceNumber& number) const {
  T factor(1);
  for (const MotionInput& one : inputs_) {
    if (one.number() != number.number) continue;
    const auto k = static_cast<std::size_t>(number.number);
    factor = factor * (number.time_number < 0 ? (one.multiplies ? static_cast<T>(one.at(t_, 0, near_)) : T(0))
                       : one.function && k < written_.size()
                           ? T(written_[k]) * static_cast<T>(one.function->by(number.time_number, t_, 0, near_))
                           : T(0));
  }
  return factor;
}

template <class T>
void InputSpring<T>::add_derivative(const ForceNumber& number, const T& by, Planar<T>* pose, const T* v, T* g) const {
  const T slope = force_by_number(law_, number.number, mechanism_.measure_of(element(), pose),
                                  mechanism_.rate_of(element(), pose, v));
  mechanism_.add_measure_gradient(element(), pose, by * this->by(number) * slope, g);
}

template <class T>
template <class NumbersOfScene>
void InputForces<T>::set_inputs(const NumbersOfScene& numbers, const std::vector<MotionInput>& inputs) {
  loads_.clear();
  springs_.clear();
  frames_.clear();
  std::map<int, std::vector<MotionInput>> of_elements;
  for (const MotionInput& input : inputs) {
    if (input.is_load()) loads_.emplace_back(numbers, mechanism_, input);
    if (input.of == MotionInput::Of::frame) frames_.push_back(input);
    if (input.of == MotionInput::Of::element) of_elements[input.item].push_back(input);
  }
  for (auto& [element, some] : of_elements) springs_.emplace_back(mechanism_, std::move(some));
  const bool some_resist = std::any_of(springs_.begin(), springs_.end(), [&](const InputSpring<T>& one) {
    return resists_motion(one.law()) || mechanism_.is_of_control(one.element());
  });
  laws_.assign(some_resist ? numbers.scene().elements.size() : 0, nullptr);
}

template <class T>
ForcesInTime<T> InputForces<T>::in_time() const {
  for (const InputSpring<T>& one : springs_) {
    if (!laws_.empty()) laws_[static_cast<std::size_t>(one.element())] = &one.law();
  }
  return {laws_.empty() ? nullptr : laws_.data(), reactions_};
}

template <class T>
T InputForces<T>::by(const ForceNumber& number) const {
  for (const InputSpring<T>& spring : springs_) {
    if (spring.element() == number.item) return spring.by(number);
  }
  return T(1);
}

template <class T>
void InputForces<T>::set(double t, double near) {
  t_ = t;
  near_ = near;
  for (InputLoad<T>& load : loads_) load.set(t, near);
  for (InputSpring<T>& spring : springs_) spring.set(t, near);
  frame_ = {};
  for (const MotionInput& one : frames_) {
    (one.function->part == 0 ? frame_.x : frame_.y) = static_cast<T>(one.at(t, one.function->order, near));
  }
}

template <class T>
void InputForces<T>::add(Planar<T>* pose, T* g) const {
  for (const InputLoad<T>& load : loads_) load.add(pose, g);
  for (const InputSpring<T>& spring : springs_) spring.add(pose, g);
  if (!frames_.empty()) mechanism_.add_frame(frame_, pose, g);
  if (past_ == nullptr) return;
  for (const TorquesOfPast::One& one : past_->at(t_, near_)) g[one.coordinate] -= static_cast<T>(one.torque);
}

template <class T>
void InputForces<T>::add_change(Planar<T>* pose, const T* dq, T* g) const {
  for (const InputLoad<T>& load : loads_) load.add_change(pose, dq, g);
  for (const InputSpring<T>& spring : springs_) spring.add_change(pose, dq, g);
  if (!frames_.empty()) mechanism_.add_frame_change(frame_, pose, dq, g);
}

template <class T>
void InputForces<T>::add_derivative(const ForceNumber& number, T by, Planar<T>* pose, const T* v, const int* sliding,
                                    T* g) const {
  if (number.of == ForceNumber::Of::frame) {
    for (const MotionInput& one : frames_) {
      const TimeFunction& function = *one.function;
      if (function.part != number.number) continue;
      by *= static_cast<T>(one.unit * function.by(number.time_number, t_, function.order, near_));
      mechanism_.add_frame(number.number == 0 ? Planar<T>{by, T(0)} : Planar<T>{T(0), by}, pose, g);
    }
    return;
  }
  if (number.of == ForceNumber::Of::element) {
    if (mechanism_.is_of_control(number.item)) {
      mechanism_.add_control_derivative({.element = number.item, .number = number.number, .by = by * this->by(number)},
                                        pose, v, in_time(), g);
      return;
    }
    for (const InputSpring<T>& spring : springs_) {
      if (spring.element() == number.item) return spring.add_derivative(number, by, pose, v, g);
    }
  }
  for (const InputLoad<T>& load : loads_) by *= load.by(number);
  mechanism_.add_force_derivative(number, by, pose, v, sliding, g);
}

}  // namespace poise
