#include "motion/joint_friction.hpp"

#include "model/couplings.hpp"
#include "model/input_error.hpp"

namespace poise {

void refuse_joint_friction(const Scene& scene, std::string_view what) {
  for (const Joint& joint : scene.joints) {
    if (!joint.friction) continue;
    throw InputError(scene.file + (joint.line > 0 ? ":" + std::to_string(joint.line) : "") + ": " +
                     std::string(joint.traits().key) + " \"" + joint.name + "\".friction: " + std::string(what) +
                     " does not treat friction that depends on the force in the joint; expected friction of a constant "
                     "force or torque, give it in a table [[friction]] instead");
  }
  for (const Stop& rope : scene.stops) {
    if (rubbing_rims(rope.on).empty()) continue;
    throw InputError(scene.file + (rope.line > 0 ? ":" + std::to_string(rope.line) : "") + ": rope \"" + rope.name +
                     "\".friction: " + std::string(what) +
                     " does not treat a rope that rubs on its pulleys; remove the key friction there");
  }
}

std::vector<std::string> joints_with_friction(const Scene& scene) {
  std::vector<std::string> out;
  for (const Joint& joint : scene.joints) {
    if (joint.friction) out.push_back("\"" + joint.name + "\"");
  }
  return out;
}

}  // namespace poise
