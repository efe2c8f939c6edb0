#include "motion/joint_friction.hpp"

namespace poise {

std::vector<std::string> joints_with_friction(const Scene& scene) {
  std::vector<std::string> out;
  for (const Joint& joint : scene.joints) {
    if (joint.friction) out.push_back("\"" + joint.name + "\"");
  }
  return out;
}

}  // namespace poise
