#pragma once

#include <string>
#include <vector>

#include "app/draw/figure.hpp"
#include "motion/design.hpp"
#include "motion/forces_along.hpp"
#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
#include "motion/motion_record.hpp"
#include "motion/simulate.hpp"

namespace poise::app {

// Pictures (SVG) of mechanisms that move. `heading` is the verdict, a warning where it is not `confirmed`.

/// At the start of the range, as shadows at its middle and its end, with the paths of points ("coupler.P"). There is
/// one sample at least.
std::string kinematics_picture(const Scene& scene, const KinematicsResult& found,
                               const std::vector<std::string>& points, const std::string& heading, bool confirmed);

/// At the start of the motion, as shadows at its middle and its end. There is one node at least.
std::string motion_picture(const MotionModel& model, const Motion& motion, const std::string& heading, bool confirmed);

/// In one pose, with the forces of joints, active stops and drives.
std::string forces_picture(const Scene& scene, const Forces& forces, const std::string& heading, bool confirmed);

// The same as figures that move, with their charts; none of them draws anything where nothing was found. `confirmed`:
// the run is.

/// Over the driven range; `points` ("coupler.P") are traced at first.
Figure kinematics_figure(const Scene& scene, const KinematicsResult& found, const std::vector<DriveRange>& ranges,
                         const std::vector<std::string>& points, bool confirmed);

/// Over time; in real time where that takes 2 s to 30 s. `panels` are over time too, and `scene` is the one before
/// resisted_by_joints(). What is touched has the arrows of its forces, impacts have signs that fade, and the first
/// events of stops are marks of what plays.
Figure motion_figure(const Scene& scene, const MotionModel& model, const Motion& motion, const MotionRecord& record,
                     std::vector<Panel> panels, bool confirmed);

/// In one pose, over a range or over time, with the forces of joints, active stops and drives.
Figure forces_figure(const Scene& scene, const ForcesAlong& found, bool confirmed);

/// The mechanism that was designed, over its range; the guided point is traced.
Figure design_figure(const DesignProblem& problem, const DesignResult& best, bool confirmed);

}  // namespace poise::app
