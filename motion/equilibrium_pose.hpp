#pragma once

#include <vector>

#include "motion/motion_model.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Converts a pose of the static model of a scene to its motion model: scaled coordinates of `motion`, from the scaled
/// coordinates `static_x` of `statics`.
///
/// Both have the same coordinates but keep different ones and may use different units. A coordinate that statics
/// dropped keeps its start value; gaps by rounding are closed by minimum-norm steps. Throws InputError if the loops
/// cannot be closed.
std::vector<double> motion_coordinates(const MotionModel& motion, const StaticModel& statics,
                                       const std::vector<double>& static_x);

/// The same from any other model of the scene, of which coordinates that cut joints make (model/joint_friction.hpp)
/// follow from the poses of the bodies.
std::vector<double> coordinates_in(const MotionModel& motion, const ScaledModel& other, const std::vector<double>& x);

/// Whether joints are cut in a layout.
bool has_cuts(const Layout& layout);

/// The widest opening of a loop at the scaled coordinates x: rad, or sizes of the mechanism.
double largest_gap(const MotionModel& motion, const std::vector<double>& x);

/// Closes the loops of the scaled coordinates x by minimum-norm steps. Throws InputError if that fails.
std::vector<double> closed_from(const MotionModel& motion, std::vector<double> x);

}  // namespace poise
