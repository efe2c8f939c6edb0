#pragma once

#include <vector>

#include "motion/motion_model.hpp"

namespace poise {

/// Whether no finite efforts of the drives hold the mechanism in the closed pose x (scaled coordinates), though there
/// is a drive for each of its degrees of freedom: the loops leave a motion u on which the drives do no work but loads
/// and springs do,
///   J u = 0,   D u = 0,   Q^T u != 0,
/// with J the Jacobian of the closures and of the stops in contact, D that of the driven quantities. A singular value
/// below 1e-5 of the largest counts as zero, and work below 1e-6 of the largest generalized force.
bool is_dead_point(const MotionModel& model, const std::vector<double>& x, const std::vector<Drive>& drives);

}  // namespace poise
