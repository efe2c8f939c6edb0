#pragma once

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

}  // namespace poise
