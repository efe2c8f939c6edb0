#pragma once

#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise {

/// Quantities in a position that drives hold, SI. A push holds it in place of the drive, where there is but one.
///
/// As if the bodies stood still where they are at an instant of their motion.
std::vector<QuantityValue> driven_quantities(const Scene& scene, const std::vector<Drive>& drives,
                                             const std::vector<BodyMotion>& bodies,
                                             const std::vector<SoughtQuantity>& of);
/// With all forces of a pose by inverse dynamics: inertia, dampers and friction too. `scene` has the loads of the
/// instant, and the drives.
std::vector<QuantityValue> driven_quantities(const Scene& scene, const Forces& forces,
                                             const std::vector<SoughtQuantity>& of);

}  // namespace poise
