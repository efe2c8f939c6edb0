#pragma once

#include <string>
#include <vector>

#include "motion/reduced_motion.hpp"

namespace poise {

/// What an error of a line begins with: "file:line: ".
std::string at_line(const std::string& file, int line);

/// Places the motion at time 0 in the pose of x, scaled, near which it is; its drives start from `closed`.
bool place_at_start(ReducedMotion<double>& motion, const std::vector<double>& closed, const std::vector<double>& x,
                    const std::vector<int>& independent);

}  // namespace poise
