#include "motion/motion_input_impl.hpp"

namespace poise {

std::vector<MotionInput> scaled(std::vector<MotionInput> inputs, const Scene& scene, const Scales& scales) {
  for (MotionInput& input : inputs) {
    if (input.multiplies) continue;
    const Dimension dimension = input.of == MotionInput::Of::force    ? scene.forces[input.item].numbers()[0].dimension
                                : input.of == MotionInput::Of::torque ? dimension::torque
                                                                      : scene.drives[input.item].on.dimension();
    input.unit *= dimension.per_scale(scales);
  }
  return inputs;
}

}  // namespace poise
