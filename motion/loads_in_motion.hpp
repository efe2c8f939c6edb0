#pragma once

#include <string>
#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/simulate.hpp"
#include "statics/equilibrium/link_loads.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {

/// What link_loads() needs of forces that were found with the drives of the scene.
ForcesInMotion in_motion(const Scene& scene, const Forces& forces);

/// Returns the quantity of a link (SoughtQuantity::is_in_link()), SI, that the internal loads of all links of a scene
/// have, or why there is none.
QuantityValue load_in_link(const SoughtQuantity& of, const Scene& scene, const std::vector<LinkLoads>& links);

/// The internal loads of links at one time of a motion, SI.
struct LoadsInMotion {
  std::string why;  ///< the motion did not reach that time: one sentence; then all that follows is empty
  std::vector<BodyPose<double>> poses;  ///< of all bodies
  Forces forces;                        ///< by inverse dynamics, with the loads and drives of the scene at that time
  std::vector<LinkLoads> links;
};

/// Simulates the motion from `start` as far as `time`, s, 0 or more, and cuts the links there: link_loads() of the
/// forces that inverse dynamics finds for the pose, the rates and the accelerations. Where accelerations jump at that
/// time they are those before the jump.
LoadsInMotion loads_in_motion(const MotionModel& model, const MotionState& start, double time, MotionOptions options);

}  // namespace poise
