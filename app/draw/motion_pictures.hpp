#pragma once

#include <string>
#include <vector>

#include "motion/inverse_dynamics.hpp"
#include "motion/kinematics.hpp"
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

}  // namespace poise::app
