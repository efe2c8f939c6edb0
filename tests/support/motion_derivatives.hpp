#pragma once

#include <string>
#include <vector>

#include "motion/simulate.hpp"

namespace poise::test {

/// Expects the derivatives of coordinates and their rates, at the end of a motion, by numbers of the scene to be those
/// of differences of motions (five points), to within rad or m per unit. Numbers that move the start must leave its
/// independent coordinates the same.
void expect_derivatives(const Scene& scene, const MotionState& start, const std::vector<std::string>& paths,
                        const std::vector<std::string>& coordinates, double duration, double within = 1e-6);

}  // namespace poise::test
