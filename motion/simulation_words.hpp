#pragma once

#include <string>
#include <vector>

#include "motion/motion_model.hpp"
#include "motion/reduced_motion.hpp"
#include "motion/simulate.hpp"
#include "motion/stick_slip.hpp"

namespace poise {

// Words about a motion that does not go on. Private to simulate().

/// What a row of the closures, drives, stops that hold and limits that are touched is of: 'pin "C"'.
std::string name_of_row(const MotionModel& model, int row, const std::vector<Touch>& touching = {});

/// Why nothing could be chosen that friction holds and that touches its stop; `rubs`: some friction sticks.
std::string words_of(StickSlip::Choice choice, bool rubs);

/// What ends a motion at a stop so named: an impact that would add energy, and a drive that pushes it.
std::string gaining_impact(const std::string& stop);
std::string pushing_drive(const std::string& stop, bool is_driven);

/// Throws InputError where no rates of the coordinates, as `reduced` has them, are those that drives ask for and keep
/// the joints closed.
void refuse_contradicting_drives(const MotionModel& model, ReducedMotion<double>& reduced);

/// Throws InputError for a force in a joint that the other joints leave open, and that its friction depends on.
[[noreturn]] void refuse_undetermined_joint(const Scene& scene, int joint);

/// How a motion ends at t where its equations fail, at these coordinates in the units of the model; not undetermined.
struct MotionEnd {
  MotionStatus status;
  std::string why;
};
MotionEnd end_of_motion(const MotionModel& model, ReducedMotion<double>::Status status, double t,
                        const std::vector<double>& q);

}  // namespace poise
