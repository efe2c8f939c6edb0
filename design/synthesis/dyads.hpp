#pragma once

#include <span>
#include <string>
#include <vector>

#include "model/planar.hpp"

namespace poise {

/// A position of a body in the plane: the origin of its frame, m, and its angle, rad.
struct BodyPosition {
  Vec2 at{};
  double angle = 0.0;
};

/// Where a point of the body's frame is in the world.
Vec2 world_of(const BodyPosition& position, const Vec2& point);

/// A link that can guide a body: a point of the body at a constant distance from a pivot of the ground; or, where one
/// of these lies at infinity, a slide.
struct GuidingDyad {
  enum class Kind {
    link,             ///< a pin on the ground and one on the body
    slide_on_ground,  ///< the point `moving` of the body travels on a straight line along `axis`, in the world
    slide_on_body     ///< a straight line of the body along `axis`, in its frame, passes the pivot `fixed`
  };
  Kind kind = Kind::link;
  Vec2 fixed{};         ///< pivot in the world
  Vec2 moving{};        ///< pin in the body's frame
  double length = 0.0;  ///< of a link, > 0
  Vec2 axis{};          ///< of a slide, a unit vector
  bool proved = false;  ///< exactly one such link lies within `radius`, of the positions as the doubles that they are
  double radius = 0.0;  ///< each coordinate is known to within this, m
};

/// The greatest difference of the lengths that a dyad has in some positions, or of the distances from its line, m.
double misfit_of(const GuidingDyad& dyad, std::span<const BodyPosition> positions);

/// All dyads that guide a body through five positions (L. Burmester, "Lehrbuch der Kinematik", 1888).
struct FiveDyads {
  /// All four solutions, real or not, are proved to be simple and apart: `dyads` are all that there are.
  bool complete = false;
  std::vector<GuidingDyad> dyads;  ///< by their pivots
  int complex = 0;                 ///< solutions that are not real, where complete
  /// The conditions depend on each other, so that infinitely many dyads may guide the body: none is given then.
  bool dependent = false;
};

/// With d and R the position and turn of the body, u the pivot, w the pin in the body's frame and L the length,
///
///   |d + R w - u|^2 = L^2
///
/// is linear in w, u, |w|^2 + |u|^2 - L^2, u . w and u x w. Five positions leave a plane of these, in which two conics
/// say that the last two are what they are; the conics meet in four points.
FiveDyads dyads_through(std::span<const BodyPosition> five);

}  // namespace poise
