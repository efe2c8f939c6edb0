#pragma once

#include <optional>
#include <span>
#include <vector>

#include "design/synthesis/dyads.hpp"

namespace poise {

/// Links that guide a body through four positions: their pivots lie on a curve of the third degree, the curve of
/// centres of L. Burmester, and each has its pin.
struct CentreCurve {
  /// `links` has points of all arcs: each line across the asymptote of the curve meets it in the points found, and the
  /// lines at which their number changes are all known; both proved.
  bool complete = false;
  /// The conditions depend on each other, so that the pivots lie on no such curve: none is given then.
  bool dependent = false;
  int arcs = 0;
  struct Point {
    int arc = 0;  ///< from 1; the points of an arc follow one another
    GuidingDyad link;
  };
  std::vector<Point> links;
  std::vector<GuidingDyad>
      slides;  ///< points of the body that travel on a straight line, and lines of it through a pivot
};

/// The curve over a part of its asymptote that has all its turns and the middle of the positions, and reaches three
/// times the farthest distance of a position from there beyond them; with so many points on an arc, and more where it
/// is steep.
CentreCurve centre_curve(std::span<const BodyPosition> four, int points_on_arc = 40);

/// All links through four positions whose pivot lies on the line through a point.
std::vector<GuidingDyad> links_on_line(std::span<const BodyPosition> four, const Vec2& at, const Vec2& direction);

/// The link whose pivot is nearest to a place, from the nearest of the points of the curve.
std::optional<GuidingDyad> link_near(std::span<const BodyPosition> four, const CentreCurve& curve, const Vec2& place);

/// The link through three positions that has its pin, or its pivot, at a place; empty where the three places of the
/// other lie on a line.
std::optional<GuidingDyad> link_with_pin(std::span<const BodyPosition> three, const Vec2& moving);
std::optional<GuidingDyad> link_with_pivot(std::span<const BodyPosition> three, const Vec2& fixed);

}  // namespace poise
