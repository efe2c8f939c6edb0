#pragma once

#include <vector>

#include "model/measure.hpp"

namespace poise {

/// A place of an outline: a point of its body and where that is, m.
struct OutlinePoint {
  PointRef point;
  Vec2 at;
};

/// Convex bodies of which one with this outline is made. A way through the points has the free side on its left; a
/// `closed` one returns to the first. Where it goes clockwise around its body the parts fill that: ears are cut off,
/// the sharpest first, until what is left is convex. Others are cut at their corners to the left, in which two parts
/// touch, and where a part would turn by half a circle; each is closed behind by a straight line or, where it so
/// remains convex, by a point of its own (Outline::backed). Consecutive points differ. Throws InputError where a closed
/// outline crosses itself.
std::vector<Outline> parts_of_outline(const std::vector<OutlinePoint>& way, bool closed);

}  // namespace poise
