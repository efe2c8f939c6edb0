#pragma once

#include <algorithm>
#include <cmath>

#include "statics/model/check.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// Encloses the forces at the equilibrium that a certificate proves, in ball arithmetic, and puts the middles of the
/// enclosures and their radii in place of the reactions and element forces of `check`, which must be that of
/// Certificate::x with its active stops.
///
/// With the enclosure of the coordinates the poses of the bodies are enclosed, and so are the forces of the elements,
/// T(g), and the equations A f = -load of all bodies cut free (statics/bodies/free_body_equations.hpp), which the exact
/// reactions satisfy exactly. For any f, with e its distance from them,
///
///   A e = -(A f + load),   so   |e| <= |A f + load| / (s - |R|)
///
/// where s is less than the least singular value of the middle of A and R are the radii of its entries:
/// [I A; A^T s^2 I] has as many negative eigenvalues as A has columns just if s is (Sylvester's law on its Schur
/// complement s^2 I - A^T A), which the signs of its pivots prove (solvers/ball_factors.hpp). f is refined by residuals
/// in balls until they are rounding only.
///
/// Joints that keep an angle, one more than needed, make columns of moments that are exactly dependent: those moments
/// are taken as `check` has them, and since A without them is proved to be of full rank, they change no other reaction
/// but the moments of joints of the same frame. Held coordinates of a neutral equilibrium may need a force, which
/// rounding of the scene's numbers explains: it is one more unknown.
///
/// Reactions that statics does not determine, and all where Certificate::rest is empty because closures hold to
/// rounding only, are those of least norm of all that satisfy the independent ones of these equations, which imply the
/// others to rounding. With the stops that carry something in `check`,
///
///   [I A^T; A 0] (f, z) = (0, -load),
///
/// is proved to be regular; that each stop pushes to its side; and that the push of any other makes f longer, which z
/// tells, or shorter at a rate of at most e, so that f is within sqrt(n) e of the least, with n such stops. Where the
/// pose is not known to more digits than are printed, the values of `check` remain, and the radii are the distances to
/// the farthest.
///
/// Without enclosure remain reactions of which that is not proved, or beyond `enclosed_unknowns` of them, of those of
/// least norm `least_norm_unknowns`. Element forces are enclosed wherever an equilibrium is proved.
void enclose_reactions(const StaticModel& model, const Certificate& certificate, Check& check);

/// A radius around a value that is converted to a unit of that SI value: with what rounding of the conversion adds.
inline double radius_in_unit(double radius, double value, double unit) {
  if (unit == 1.0) return radius;
  return (radius * (1.0 + 0x1p-50) + std::abs(value) * 0x1p-51) / unit;
}

/// The same of a reaction's force and axial force.
inline double force_radius_in_unit(const Reaction& reaction, double unit) {
  return radius_in_unit(reaction.radius, std::max(norm(reaction.force), std::abs(reaction.axial)), unit);
}

/// Joint force components beyond which reactions are not enclosed, because that takes longer than the certificate.
inline constexpr int enclosed_unknowns = 30000;
/// The same of those of least norm, whose system is dense.
inline constexpr int least_norm_unknowns = 200;

}  // namespace poise
