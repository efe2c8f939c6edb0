#pragma once

// Tables of a scene file that bind measures to one another: each makes one stop on a sum of measures
// (model/laws/stop.hpp).

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "model/laws/stop.hpp"

namespace poise {

struct Scene;

/// What a number of a coupling is in its stop: the value that the measure is held at (or the limit that it has), its
/// lower or upper limit, the factor of a term of the sum, or the shift of a term's profile: the number times `times`,
/// and `Stop::sense` with `by_sense`. Several parts of `value` add up.
struct CouplingPart {
  enum class Of { value, lower, upper, factor, shift };
  Of of = Of::value;
  int term = 0;
  int number = 0;  ///< index into CouplingKind::numbers
  double times = 1.0;
  bool by_sense = false;

  double multiplier(const Stop& stop) const { return by_sense ? times * stop.sense : times; }
};

/// A kind of coupling: its table, its numbers, and what each of these is in its stop. A coupling of several rows is as
/// many stops, one behind the other: those behind the first are kinds of their own, which no table of a file has; their
/// numbers are those of the first.
struct CouplingKind {
  std::string_view table;
  std::span<const Number> numbers;
  std::span<const CouplingPart> parts;
  int row = 0;  ///< stops before it that belong to its coupling
};

/// All kinds:
///
///   gear      angle of wheel b = phase -+ ratio angle of wheel a, both from their carrier; - of wheels that mesh
///             outside, + of one inside the other (R. Willis, "Principles of Mechanism", 1841: planetary gears)
///   belt      the same with the signs exchanged: + of an open belt, - of a crossed one
///   rack      travel of the rack = offset + radius times the angle of the pinion from its carrier
///   cam       follower >= base + lift P((angle - phase) / turn); = where it is guided on both sides
///   geneva    angle of the wheel + 2 pi / slots P((angle of the crank - phase) / turn) = offset, both from their
///   carrier,
///             with the profile P of ProfileIn::geneva()
///   coupling  sum of factor times measure = value
///   rope      length of a rope over points and pulleys <= length
///   chain     length of the strand from the rim of one sprocket to that of another, with what is wound off and on,
///             = length (<= length of one that may go slack): in the frame of the strand, at an angle psi, component
///             along it of the way between the centres + R_a (psi - angle of a) - R_b (psi - angle of b), with radii
///             positive where the strand passes counter-clockwise, as of a rope; behind it
///     _line, _crossed_line  component of that way across the strand = R_b - R_a
///     _straight    straight length >= 0
///   circular_slot  distance of the pin from the centre = radius; of one with ends the component of the pin along the
///                line of centres, which turns with it, and behind it
///     _line        component across that line = 0
///     _ends        from <= angle of that line from the slot's body <= to
///   curved_slot    from <= travel s <= to along a spline (X(s), Y(s)); behind it, in the frame of the slot's body,
///     _x, _y       component of the pin along x (y) = X(s) (Y(s))
///   rolling        component across a line of a wheel's centre = radius; behind it
///     _friction    component along it + radius times the angle of the wheel from the line's body = offset
///   rolling_on_circle  component along the line of centres of a wheel's centre = circle_radius + sense radius, sense 1
///                outside of the circle, -1 inside; behind it, with the angle a of the line of centres,
///     _friction    radius (angle of the wheel - a) - sense circle_radius (a - angle of the circle) - sense times the
///                  row behind it = offset
///     _line        component across the line of centres of the wheel's centre = 0
///   rolling_profile  component across a line of the origin of a body's curve + its `across` = 0; behind it, with the
///                functions of model/rolling_profile.hpp at the travel s along that curve,
///     _friction    component along it + `along` - `length` = offset
///     _tangent     angle of the body from the line's body + `angle` = angle of the line in its body
///     _ends        of an open curve, from <= s <= to
///   rolling_profile_on_circle  component along the radius to the contact of the curve's origin + sense `across` =
///                circle_radius, sense 1 outside of the circle, -1 inside; behind it, with the angle a of that radius,
///     _friction    - sense times the component across + `along` - `length` - sense circle_radius (a - angle of the
///                  circle) = offset
///     _tangent     angle of the body from the radius + `angle` = - sense pi / 2
///     _line        - sense times the component across + `along` = 0
///     _ends        of an open curve, from <= s <= to
///   curve_contact  distance of two closed curves >= radius: with the functions of model/rolling_profile.hpp at the
///                  travels s and t along them, component to the right of the tangent that they share of the way from
///                  the origin of the first to that of the second + their `across`; behind it
///     _along         component along that tangent - their `along` = 0
///     _tangent       angle of the body of the first from the tangent + `angle` = 0
///     _against_tangent  the same of the second = pi
///   contact        clearance of a point from an outline, a convex part of it, >= radius
///     _part.1, ...   the same of as many other parts as there are
std::span<const CouplingKind> coupling_kinds();

/// An outline is made of at most so many convex parts behind its first.
inline constexpr std::size_t most_contact_parts = 63;
/// Whether a stop is one of those of a contact between bodies.
bool is_contact(const Stop& stop);

/// Of the wheel of a Geneva drive.
int slots_of(const Stop& geneva);

/// Index of the pressure angle in the numbers of a gear or rack.
inline constexpr int pressure_angle_at = 2;

/// As many pulleys of a rope have friction.
inline constexpr std::size_t most_rubbing_rims = 16;
/// Indices of the contacts of a rope that have friction, also one of 0. Their coefficients are the rope's numbers
/// friction.1, friction.2, ... in that order.
std::vector<int> rubbing_rims(const Measure& rope);

/// As many points of the curve of a cam, but its last, of a curved slot or of a profile that rolls are numbers; those
/// of a longer one are not.
inline constexpr std::size_t most_curve_points = 64;
/// Which numbers of a coupling are points of its curve: of a cam the shares curve.1, ..., the last point of the turn
/// being the first again; of others curve.1.x, curve.1.y, ...
struct CurveNumbers {
  int first = 0;       ///< index into the numbers
  int points = 0;      ///< 0 of couplings without
  int components = 1;  ///< numbers of a point

  bool has(int number) const { return number >= first && number < first + points * components; }
};
/// Of the first stop of a coupling.
CurveNumbers curve_numbers_of(const Stop& stop);
/// Whether it is a profile that rolls on a line or a circle.
bool is_rolling_profile(const Stop& stop);
/// Gives the stops of a coupling, of which this is the first, the profiles that follow from the points of its curve,
/// and a slot or a profile that rolls the end of it. The angle of a profile's tangent goes on from the one before:
/// where the first point turns over pi no whole turn is lost. Leaves all as they are where check_curve() throws.
void follow_curve(Stop* rows);
/// Throws InputError where two points of the curve of these stops coincide that follow each other, it ends before the
/// slot or profile begins, or does not roll (rolling_profile_on()).
void check_curve(const Stop* rows);

/// The kind of a stop; null of a plain one.
const CouplingKind* coupling_kind(const Stop& stop);

}  // namespace poise
