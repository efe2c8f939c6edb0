#include "motion/motion_model.hpp"

#include <utility>

namespace poise {
namespace {

/// Drives that follow functions of time begin with the value, rate and acceleration of these.
Scene started(Scene scene) {
  start_drives_at(scene, 0.0);
  return scene;
}

}  // namespace

MotionModel::MotionModel(Scene scene)
    : ScaledModel(started(std::move(scene)), Purpose::dynamics),
      scaled_(scaled(this->scene(), scales())),
      inertia_(scaled_, mechanism()) {}

MotionModel::MotionModel(Scene scene, const Scales& scales, const Scene* also)
    : ScaledModel(started(std::move(scene)), Purpose::dynamics, scales, also),
      scaled_(scaled(this->scene(), scales)),
      inertia_(scaled_, mechanism()) {}

}  // namespace poise
