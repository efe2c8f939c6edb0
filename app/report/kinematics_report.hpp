#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "motion/kinematics.hpp"

namespace poise::app {

/// What `poise kinematics` prints: how far the range could be driven, singular poses, and values, rates and second
/// derivatives of all coordinates, and of the points asked for ("crank.B"), over the first drive; long ranges are
/// thinned to what a screen holds. Throws InputError where a point is not the scene's.
std::string kinematics_report(const Scene& scene, const KinematicsResult& result, const std::vector<DriveRange>& ranges,
                              double rate, const std::vector<std::string>& points, const Palette& palette);

}  // namespace poise::app
