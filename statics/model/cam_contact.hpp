#pragma once

// How the pitch curve of a cam touches its follower: the curve on which, seen from the cam, the centre of the
// follower's roller runs (model/cam_geometry.hpp).

#include <optional>
#include <string>
#include <vector>

#include "model/cam_geometry.hpp"
#include "model/mechanism.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// The contact of a cam and its follower in one pose. With r from the cam's axis to the centre of the roller, t the
/// direction in which that centre moves against the base as the follower's measure g grows, by l per unit of it, and g'
/// the slope of g over the angle by which the cam turns, counter-clockwise against the base,
///
///   tan(pressure_angle) = (l g' - r x t) / (r . t)
///
/// For a follower that slides on a line at the offset e from the axis, at s from the foot of the axis on it, that is
/// (g' - e) / s (R. L. Norton, "Cam Design and Manufacturing Handbook", 2009, chapter 7). The force on the follower is
/// normal to the pitch curve, without friction, so that its part along t does the work of the effort Q on g:
///
///   normal = Q / (l cos(pressure_angle)),  side = Q / l tan(pressure_angle)
struct CamContact {
  /// From t to the normal of the pitch curve, counter-clockwise, between -pi/2 and pi/2, rad.
  double pressure_angle = 0.0;
  double normal = 0.0;  ///< N, positive where the cam presses, negative where a guided one pulls
  double side = 0.0;    ///< N, component of that force across t, along t turned by +90 degrees
};

/// A cam whose geometry the scene says, and its contact. It has none where it has lifted off, where the pitch curve has
/// no direction at the roller, and where the roller moves along it, so that no finite force drives it.
struct CamReading {
  std::string name;
  std::optional<CamContact> contact;
};

/// Those of the scene, in its order. A cam that may lift off touches where it is among the reactions.
std::vector<CamReading> cam_readings(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                     const std::vector<Reaction>& reactions);

}  // namespace poise
