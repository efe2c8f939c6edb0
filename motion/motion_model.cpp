#include "motion/motion_model.hpp"

#include <utility>

namespace poise {

MotionModel::MotionModel(Scene scene)
    : ScaledModel(std::move(scene), Purpose::dynamics),
      scaled_(scaled(this->scene(), scales())),
      inertia_(scaled_, mechanism()) {}

MotionModel::MotionModel(Scene scene, const Scales& scales, const Scene* also)
    : ScaledModel(std::move(scene), Purpose::dynamics, scales, also),
      scaled_(scaled(this->scene(), scales)),
      inertia_(scaled_, mechanism()) {}

}  // namespace poise
