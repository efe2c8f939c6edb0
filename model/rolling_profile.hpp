#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/planar.hpp"
#include "model/profile.hpp"
#include "model/scene.hpp"

namespace poise {

/// A curve of a body that rolls on another: functions of u, which goes from 0 to 1 over the sum of the curve's chords.
/// The curve is the cubic spline r(u) through its points; a closed one repeats, an open one has ends as curved as what
/// is behind them. With the tangent's angle a from the x axis of the body,
///
///   angle    a, rad, unwrapped; in (-pi, pi] at the first point
///   length   arc from the first point, m
///   along    r.(cos a, sin a), m
///   across   r.(-sin a, cos a), m: - the distance of the tangent from the origin where that is on its left
///
/// along' = angle' across + length',  across' = -angle' along.  The curvature is angle' / length', positive where the
/// curve bends to its left.
struct RollingProfile {
  double chords = 0.0;  ///< their sum, m
  std::shared_ptr<const Profile> angle, length, along, across;
};

/// Where points are along the polygon through them, m: sums of chords from the first; of a closed one with the first
/// point once more at the end.
std::vector<double> sums_of_chords(const std::vector<Vec2>& points, bool is_closed);

/// Through three points or more, m, each unlike the one before; of a closed curve the last is the first once more. None
/// if the curve comes to a stop somewhere, or nearly so, as in a cusp.
std::optional<RollingProfile> rolling_profile(const std::vector<Vec2>& points, bool is_closed);

/// Where the curve of a profile that rolls has its point at u, m, from its origin and along the axes of its body;
/// `rows` are its stops, from the first on.
Vec2 point_of_profile(const Stop* rows, double u);
/// From where to where it rolls, as u: of an open one between its ends, of a closed one all round.
std::pair<double, double> range_of_profile(const Scene& scene, std::size_t first);

}  // namespace poise
