#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// For motion: the scene with a force element for every joint with friction, on its angle or travel, that has the
/// constant part of its bound: friction that sticks (DryFriction of width 0), with the table and the name of the joint;
/// and one for every stop with friction, on its tangent_of().
/// Elements that the scene has keep their places. The rest of the bound, which grows with the force in the joint, is
/// added by ReducedMotion; for it lay_out() leaves such joints out of its tree, so that their forces are multipliers of
/// closures. A scene that has been resisted already is returned as it is.
Scene resisted_by_joints(Scene scene);

/// Lets these elements of a scene follow the numbers of its joints, which may have changed. Without effect on other
/// scenes.
void let_friction_follow(Scene& scene);

/// The measure along which what touches a stop slides: Stop::tangent(), or of a cam with a roller, whose edge rubs on
/// it, Measure::Kind::slip_on_cam. None of others.
std::optional<Measure> tangent_of(const Scene& scene, int stop);

/// Index of the element of a stop with friction, on its tangent_of(), in a scene that is resisted_by_joints(), else -1.
/// It has no constant part.
int stop_friction_element(const Scene& scene, int stop);
/// The stop of such an element, else -1.
int stop_rubbed_by(const Scene& scene, int element);

/// Index of the element of a joint with friction in a scene that is resisted_by_joints(), else -1.
int friction_element(const Scene& scene, int joint);

/// What the size of the force in a joint with friction is multiplied by in its bound: r mu / sqrt(1 + mu^2) of a pin,
/// m, mu of others.
double grip_factor(const Joint& joint);
/// The same of the joint of this index, with the numbers of a scene.
template <class NumbersOfScene>
auto grip_factor(const NumbersOfScene& numbers, int joint) {
  using std::sqrt;
  using T = typename NumbersOfScene::Scalar;
  const T& coefficient = numbers.friction(joint, 0);
  if (numbers.scene().joints[static_cast<std::size_t>(joint)].has_travel()) return T(coefficient);
  return T(numbers.friction(joint, 1) * coefficient / sqrt(T(1) + coefficient * coefficient));
}

/// Whether a joint has an element, and a bound that grows with its force.
bool grips(const Scene& scene, int joint);

/// Throws InputError naming the first rope with friction on its pulleys, which `what` does not treat.
void refuse_rubbing_ropes(const Scene& scene, std::string_view what);

/// The names of joints with friction, each in quotes.
std::vector<std::string> joints_with_friction(const Scene& scene);

}  // namespace poise
