#include <algorithm>
#include <cmath>
#include <utility>

#include "motion/motion_input_impl.hpp"

namespace poise {

std::vector<MotionInput> scaled(std::vector<MotionInput> inputs, const Scene& scene, const Scales& scales) {
  for (MotionInput& input : inputs) {
    if (input.multiplies) continue;  // a number
    if (input.of == MotionInput::Of::frame) {
      input.unit *= dimension::length.per_scale(scales);
      continue;
    }
    const Dimension dimension =
        input.of == MotionInput::Of::force    ? scene.forces[input.item].numbers()[0].dimension
        : input.of == MotionInput::Of::torque ? dimension::torque
        : input.of == MotionInput::Of::element
            ? numbers_of(scene.elements[input.item].law)[static_cast<std::size_t>(input.part)].dimension_on(
                  &scene.elements[input.item].on)
            : scene.drives[input.item].on.dimension();
    input.unit *= dimension.per_scale(scales);
  }
  return inputs;
}

const TimeFunction* without_value(const std::vector<MotionInput>& inputs, double t, double behind) {
  for (const MotionInput& input : inputs) {
    if (!input.function) continue;
    const int last = input.of == MotionInput::Of::drive ? 2 : input.function->order;
    for (const double at : {t, t + behind}) {
      for (int derivative = 0; derivative <= last; ++derivative) {
        if (!std::isfinite(input.at(at, derivative, at))) return input.function.get();
      }
    }
  }
  return nullptr;
}

std::vector<MotionInput> inputs_of(const Scene& scene) {
  std::vector<MotionInput> out;
  for (const TimeFunction& function : scene.time_functions) {
    MotionInput input{.item = function.item, .curve = {}, .multiplies = true};
    input.function = std::make_shared<const TimeFunction>(function);
    input.of = function.of;
    input.multiplies = function.of != TimeFunction::Of::drive && function.of != TimeFunction::Of::frame;
    out.push_back(std::move(input));
  }
  return out;
}

std::vector<MotionInput> with_inputs_of(const Scene& scene, std::vector<MotionInput> inputs) {
  const auto given = static_cast<std::ptrdiff_t>(inputs.size());
  for (MotionInput& own : inputs_of(scene)) {
    const bool replaced = std::any_of(inputs.begin(), inputs.begin() + given, [&](const MotionInput& other) {
      const bool of_one_item = other.of == own.of && other.item == own.item;
      return of_one_item && (own.of != MotionInput::Of::element || other.number() == own.number());
    });
    if (!replaced) inputs.push_back(std::move(own));
  }
  return inputs;
}

}  // namespace poise
