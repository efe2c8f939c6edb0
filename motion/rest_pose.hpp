#pragma once

#include <vector>

#include "motion/motion_model.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// Carries a pose of the static model of a scene over to its motion model: scaled coordinates of `motion`, from the
/// scaled coordinates `static_x` of `statics`.
///
/// Both lay out the same coordinates but keep different ones and may measure in different units. A coordinate that
/// statics dropped stays at its start value; loops that rounding leaves open are closed by the shortest steps.
/// Throws InputError where they cannot be closed.
std::vector<double> motion_coordinates(const MotionModel& motion, const StaticModel& statics,
                                       const std::vector<double>& static_x);

}  // namespace poise
