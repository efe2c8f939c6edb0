#include "motion/motion_model.hpp"

#include <utility>
#include <vector>

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

MotionModel::MotionModel(Scene scene, const Scales& scales, const VaryingNumbers& varying)
    : ScaledModel(started(std::move(scene)), Purpose::dynamics, scales, varying),
      scaled_(scaled(this->scene(), scales)),
      inertia_(scaled_, mechanism()) {}

VaryingNumbers loads_in_time(const Scene& scene) {
  std::vector<ParameterPlace> rows;
  for (const TimeFunction& function : scene.time_functions) {
    const auto item = static_cast<std::size_t>(function.item);
    if (function.of == TimeFunction::Of::force && !(scene.forces[item].vector == Vec2{})) {
      rows.push_back({Owner::force, function.item});
    } else if (function.of == TimeFunction::Of::torque && scene.torques[item].value != 0.0) {
      rows.push_back({Owner::torque, function.item});
    } else if (function.of == TimeFunction::Of::element || function.of == TimeFunction::Of::frame) {
      rows.push_back({owner_of(function.of), function.item, 0, function.part});
    }
  }
  return {scene, rows};
}

}  // namespace poise
