#pragma once

#include <vector>

#include "model/scene.hpp"
#include "motion/body_motion.hpp"

namespace poise {

/// What a controller of a scene in SI does where the bodies move so (see ControlOutputs), its reference and its other
/// numbers those of the scene.
ControlOutputs<double> control_outputs(const Scene& scene, const Element& controller,
                                       const std::vector<BodyMotion>& motions);

}  // namespace poise
