#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// Stability of an equilibrium by the inertia of its reduced Hessian (Morse index).
enum class Stability { unknown, stable, unstable, neutral };

/// "stable", "unstable", ...
std::string to_string(Stability stability);

/// A principal direction of the reduced Hessian  Z^T (grad2 V + sum lambda grad2 c) Z,  Z an orthonormal basis of the
/// null space of the closure Jacobian in scaled coordinates (rad, mechanism sizes).
struct CurvatureDirection {
  double curvature = 0.0;  ///< J per (unit of scaled coordinates)^2, positive where stable
  /// Coordinates that move, largest first, with their component of the unit direction.
  std::vector<std::pair<std::string, double>> moves;
};

/// Reaction of one joint, bar or active stop. Force (N, world directions) and moment (N m) act on the joint's second
/// body at the point `at` (world, m), with the opposite on its first.
struct Reaction {
  std::string name;
  std::string kind;  ///< "pin", "slide", "pin_in_slot", "weld", "bar", "stop"
  Vec2 at{};
  Vec2 force{};
  double moment = 0.0;
  double axial = 0.0;      ///< bars, distance and travel stops: N, tension positive
  bool determined = true;  ///< false: statically indeterminate, the set of minimum norm (moments over size)
};

/// Bounds within which a result counts as an equilibrium.
struct CheckTolerances {
  double closure = 1e-9;    ///< largest gap of a joint / size of the mechanism
  double imbalance = 1e-9;  ///< largest unbalanced force, or moment / size, of a body / largest force on any body
  /// Largest distance, rad or / size, to the exact equilibrium: by a Newton step, or by 50 digits where curvatures are
  /// too small or reactions too large for double precision.
  double position = 1e-6;
  double stop = 1e-8;  ///< stop overrun, rad or / size
  /// A curvature counts as zero below this share of the largest stiffness.
  double neutral = 1e-13;
};

/// Result of the check by free-body statics, which is independent of the search.
struct Check {
  double closure_error = 0.0;  ///< m: largest gap of any joint, from the poses of the bodies
  std::string worst_joint;
  double imbalance = 0.0;  ///< N: largest unbalanced force, or moment / size, of any body
  std::string worst_body;
  double largest_force = 0.0;   ///< N: largest load, spring force or reaction on any body
  double stop_violation = 0.0;  ///< rad, or m / size
  std::string worst_stop;
  bool closed = false;
  bool balanced = false;
  bool stops_kept = false;
  std::vector<Reaction> reactions;
  int redundancy = 0;  ///< number of independent states of self-stress (degree of static indeterminacy)

  Stability stability = Stability::unknown;
  int unstable_directions = 0;                           ///< number of negative curvatures
  int neutral_directions = 0;                            ///< number of zero curvatures
  std::vector<CurvatureDirection> principal_directions;  ///< lowest curvatures first, at most six
  std::string stability_note;

  /// In a singular configuration: the closures lose rank and no finite joint forces balance the loads.
  bool singular = false;
  /// Conditioning limit: bound on the change of this equilibrium by rounding of the scene's numbers and of their
  /// evaluation, rad or mechanism sizes. The larger of 64 eps / |smallest scaled curvature|, which is far more than eps
  /// near a fold, where equilibria merge, and of the change caused by gaps of 4 eps, which is far more near a singular
  /// pose, where reactions are large. Empty if curvatures are unknown.
  std::optional<double> accuracy;
  /// The same of all coordinates across the neutral directions, along which the position is arbitrary. Empty where
  /// there are none, or curvatures are unknown.
  std::optional<double> accuracy_across_neutral;

  /// Closed, balanced and within its stops.
  bool is_equilibrium() const { return closed && balanced && stops_kept; }
  /// Why it is not an equilibrium, one sentence; empty if it is.
  std::string objection;
};

/// Checks the scaled coordinates x of a model:
///
/// closure    every joint of the scene, measured between the poses of its two bodies
/// balance    vector statics: each body cut free under its loads and the reactions of its joints; the reactions are
///            the least-squares solution of all bodies' 3 equations, so what they cannot balance remains as imbalance
/// position   a small imbalance may still be far from equilibrium if the mechanism is soft: one Newton step estimates
///            the distance
/// stability  inertia of the reduced Hessian, with active stops counted as closures; if the smallest curvature is
///            within rounding of zero its sign is taken from 50 digits
Check check(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances = {});

}  // namespace poise
