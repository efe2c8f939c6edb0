#pragma once

// Singular poses in words. Private to the kinematics.

#include <string>

#include "motion/driven_path.hpp"

namespace poise {

/// " of the loop closed by "D": coupler and rocker are in line", " of "length.shock": arm can move while the drives are
/// fixed": which closures and driven measures are dependent there, and what could move. Needs the singular vectors of
/// the pose.
std::string describe_singularity(const SplitClosure& closure, const PathPose& pose);

}  // namespace poise
