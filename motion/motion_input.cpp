#include <algorithm>
#include <utility>

#include "motion/motion_input_impl.hpp"

namespace poise {

std::vector<MotionInput> scaled(std::vector<MotionInput> inputs, const Scene& scene, const Scales& scales) {
  for (MotionInput& input : inputs) {
    if (input.multiplies) continue;  // a number
    const Dimension dimension = input.of == MotionInput::Of::force    ? scene.forces[input.item].numbers()[0].dimension
                                : input.of == MotionInput::Of::torque ? dimension::torque
                                                                      : scene.drives[input.item].on.dimension();
    input.unit *= dimension.per_scale(scales);
  }
  return inputs;
}

std::vector<MotionInput> inputs_of(const Scene& scene) {
  std::vector<MotionInput> out;
  for (const TimeFunction& function : scene.time_functions) {
    MotionInput input{.item = function.item, .curve = {}, .multiplies = true};
    input.function = std::make_shared<const TimeFunction>(function);
    switch (function.of) {
      case TimeFunction::Of::force:
        input.of = MotionInput::Of::force;
        break;
      case TimeFunction::Of::torque:
        input.of = MotionInput::Of::torque;
        break;
      case TimeFunction::Of::drive:
        input.of = MotionInput::Of::drive;
        input.multiplies = false;
        break;
    }
    out.push_back(std::move(input));
  }
  return out;
}

std::vector<MotionInput> with_inputs_of(const Scene& scene, std::vector<MotionInput> inputs) {
  for (MotionInput& own : inputs_of(scene)) {
    const bool replaced = std::any_of(inputs.begin(), inputs.end(), [&](const MotionInput& other) {
      return other.of == own.of && other.item == own.item;
    });
    if (!replaced) inputs.push_back(std::move(own));
  }
  return inputs;
}

}  // namespace poise
