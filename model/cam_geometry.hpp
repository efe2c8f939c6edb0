#pragma once

#include <optional>

#include "model/scene.hpp"

namespace poise {

/// Where a cam and the roller of its follower are, for a cam whose geometry the scene says: its body turns about a pin
/// of it and a base body, which are the two bodies of its angle, and its follower
///
///   slides  on a slide or pin in a slot, whose first point is of the base; the centre of the roller is its second
///           point, or the one that the scene names, or
///   turns   about a pin of the same base, against which its angle is; the scene names the centre of the roller.
///
/// A knife-edged follower has its edge in place of that centre.
struct CamGeometry {
  PointRef axis;            ///< of the cam, on the base
  PointRef on_cam;          ///< the same place, on the cam
  double sense = 1.0;       ///< -1 where the angle of the cam is that of the base against it
  PointRef roller;          ///< centre, a point of the follower
  int slide = -1;           ///< joint on which the follower slides; -1 where it turns
  PointRef pivot{};         ///< of a follower that turns, on the base
  PointRef on_follower{};   ///< the same place, on the follower
  double turn_sense = 1.0;  ///< -1 where its angle is that of the base against it
};

/// Of a stop of the scene; nothing of other stops and of cams whose geometry the scene does not say.
std::optional<CamGeometry> cam_geometry(const Scene& scene, const Stop& stop);

}  // namespace poise
