#include "motion/motion_model.hpp"

#include <utility>

namespace poise {

MotionModel::MotionModel(Scene scene)
    : ScaledModel(std::move(scene), Purpose::dynamics), inertia_(scaled_scene(), mechanism()) {}

MotionModel::MotionModel(Scene scene, const Scales& scales)
    : ScaledModel(std::move(scene), Purpose::dynamics, scales), inertia_(scaled_scene(), mechanism()) {}

}  // namespace poise
