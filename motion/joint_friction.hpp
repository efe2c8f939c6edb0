#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// Throws InputError naming the first joint with friction: its bound depends on the force in the joint, which `what`
/// does not treat; or the first rope with friction on its pulleys. Friction of constant bounds is [[friction]].
void refuse_joint_friction(const Scene& scene, std::string_view what);

/// The names of joints with friction, each in quotes.
std::vector<std::string> joints_with_friction(const Scene& scene);

}  // namespace poise
