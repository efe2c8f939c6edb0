#pragma once

#include <vector>

#include <Eigen/Core>

#include "model/laws/stop.hpp"

namespace poise {

/// A limit of a stop that is touched at an impact.
struct ImpactSide {
  double rate = 0.0;  ///< of its gap before: negative where it closes
  double restitution = 0.0;
  double friction = 0.0;  ///< coefficient of Coulomb friction
  double slip = 0.0;      ///< rate along it before
};

/// What an impact does; one value for each side.
struct Impact {
  bool found = false;           ///< false where no impulses keep the gaps from closing: what is driven pushes
  std::vector<double> impulse;  ///< P >= 0
  std::vector<double> rub;      ///< impulse of friction, along the slip
  std::vector<double> rate;     ///< of the gap after it, >= 0 but for rounding
  std::vector<double> slip;     ///< after it, along the friction; 0 of sides without
  /// The energy that it takes: minus the sum of the impulses times the means of their rates before and after; negative
  /// where the law would add some.
  double energy_lost = 0.0;
  bool gains = false;  ///< it would add energy, by more than rounding
  /// False where several sides touch and what happens depends on the order in which they act, which rigid bodies do not
  /// tell.
  bool unique = true;
};

/// Impact at several sides at once, m of them. With the impulses P their gaps' rates are  u = u_before + D P;  D is
/// symmetric and positive semidefinite, D_ij the rate that a unit impulse at side j gives to the gap of side i. Where
/// some side has friction D has 2 m rows: those of the gaps, then those of the slips.
///
/// Without friction:
///   newton     0 <= P  complementary to  u + e u_before >= 0, in which e is the restitution of a side that closes
///   others     compression  0 <= P_c  complementary to  u_c = u_before + D P_c >= 0,  then expansion  P_e = s e P_c:
///     poisson    s = 1
///     energetic  s such that  P_e^T D P_e = sum e^2 P_c (D P_c), the energy that Stronge's coefficients give
///              back (at most that of the compression),
///              and a last compression where a gap would close by that.
/// At a single side all three give  P = -(1 + e) u_before / D.  The energetic law never adds energy.
///
/// With friction, where the impulse at the one side that closes opens or keeps the gaps of all others, it is followed
/// as it grows (Routh's method): the friction is mu times it against the slip, until that stops; then the side sticks,
/// or slips back where sticking takes more. The compression ends where the gap's rate is zero. The expansion ends, of
/// the energetic law, where the gap has done e^2 of the work taken in the compression; of Poisson's, with e times its
/// impulse. Newton's law, and several sides, are one complementarity problem, in which the friction is that of the
/// final slip. There the energetic law takes the largest share of the restitution that adds no energy.
/// Sources: J. J. Moreau, Unilateral contact and dry friction in finite freedom dynamics, 1988; F. Pfeiffer, C.
/// Glocker, Multibody Dynamics with Unilateral Contacts, 1996; W. J. Stronge, Impact Mechanics, 2000.
Impact impact(const Eigen::MatrixXd& D, const std::vector<ImpactSide>& sides, ImpactLaw law);

/// Derivatives of Impact::impulse and Impact::rub.
struct ImpulseChange {
  std::vector<double> impulse, rub;
};

/// The derivatives of the impulses along a change of D and of what the sides have, while the same of them act, slip
/// and stick: exact, in dual numbers.
ImpulseChange impulse_change(const Eigen::MatrixXd& D, const Eigen::MatrixXd& change,
                             const std::vector<ImpactSide>& sides, const std::vector<ImpactSide>& changes,
                             ImpactLaw law);

}  // namespace poise
