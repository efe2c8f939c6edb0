#pragma once

#include <optional>
#include <vector>

#include "model/scene.hpp"
#include "motion/body_motion.hpp"
#include "motion/motion_model.hpp"

namespace poise {

/// What a controller of a scene in SI does where the bodies move so (see ControlOutputs), its reference and its other
/// numbers those of the scene.
ControlOutputs<double> control_outputs(const Scene& scene, const Element& controller,
                                       const std::vector<BodyMotion>& motions);

/// The scene, or in `room` one that has, for good, the numbers that its controllers set there (Feedback::Sets).
const Scene& with_set_numbers(const Scene& scene, const std::vector<BodyMotion>& motions, std::optional<Scene>& room);

/// Throws InputError for a controller on a measure that the joints keep, on which it does nothing.
void refuse_idle_controllers(const MotionModel& model);

}  // namespace poise
