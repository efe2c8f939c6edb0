#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"
#include "motion/forces_in_time.hpp"
#include "motion/kinematics.hpp"
#include "motion/motion_record.hpp"

namespace poise::app {

// Charts of mechanisms that move, in the units of the scene, at most twelve curves each.

/// Values, rates and second derivatives of angles and of lengths over the first drive.
std::vector<Panel> kinematics_panels(const Scene& scene, const KinematicsResult& found,
                                     const std::vector<DriveRange>& ranges);

/// Charts points "crank.B": first their paths, then their speeds and their accelerations over the first drive.
std::vector<Panel> point_panels(const Scene& scene, const KinematicsResult& found,
                                const std::vector<DriveRange>& ranges, const std::vector<std::string>& points);

/// Angles, travels and energies over time: of those that move most; where all move little for how far apart they are,
/// counted from where they start. The sum of the energies has marks at the first events of stops, numbered as the
/// table of them.
std::vector<Panel> motion_panels(const Scene& scene, const MotionRecord& record,
                                 const std::vector<ContactEvent>& events = {});

/// So many events of stops are marked, and listed in text.
inline constexpr std::size_t shown_contact_events = 12;

/// What happens at a stop: "impact", "lift-off"; of ropes and chains "taut", "slack".
std::string words_of(const ContactEvent& event, const Stop& stop);
/// Where: "floor (min)".
std::string side_of(const ContactEvent& event, const Stop& stop);

/// Efforts of drives and sizes of joint forces over a range or time.
std::vector<Panel> forces_panels(const Scene& scene, const ForcesAlong& found);

/// Forces over a simulated motion, which has the work of drives and the largest bending moments of links too.
std::vector<Panel> forces_in_time_panels(const Scene& scene, const ForceHistory& found);

}  // namespace poise::app
