#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// A force (N, world directions) and a moment (N m) on a body at the point `at` (world, m), and their proved distances
/// from the exact ones, N and N m; infinite where nothing is proved.
struct BodyForce {
  int body = 0;
  Vec2 at{};
  Vec2 force{};
  double moment = 0.0;
  double radius = std::numeric_limits<double>::infinity();
  double moment_radius = std::numeric_limits<double>::infinity();
};

/// Reaction of one joint, bar or active stop. Force (N, world directions) and moment (N m) act on `body_b`, the joint's
/// second body, at the point `at` (world, m), with the opposite on `body_a`; unless `parts` says otherwise.
struct Reaction {
  std::string name;
  std::string
      kind;  ///< "pin", "slide", "pin_in_slot", "weld", "bar", "drive", or the table of a stop: "stop", "gear", ...
  int stop = -1;  ///< index in Scene::stops; -1 of a joint, bar or drive
  int body_a = 0, body_b = 0;
  Vec2 at{};
  /// A stop on a rope has those on its last contact, one on a sum (of a coupling, a cam) those on its first measure.
  Vec2 force{};
  double moment = 0.0;
  double axial = 0.0;  ///< bars, stops on lengths: N, tension positive
  /// False: statically indeterminate, the set of minimum norm (moments over size) in which one-sided stops push.
  bool determined = true;
  /// An undetermined stop may be slack if others that touch can carry its loads, to 1e-9 of the largest force; false if
  /// it is proved that they cannot (Certificate::needed_stops).
  std::optional<bool> may_be_idle{};
  /// Proved distances of `force` (its length) and `axial`, N, and of `moment`, N m, from the exact ones; infinite where
  /// nothing is proved (statics/enclosed_reactions.hpp).
  double radius = std::numeric_limits<double>::infinity();
  double moment_radius = std::numeric_limits<double>::infinity();
  /// A stop that acts on more than two places (a rope, a sum), or elsewhere than its measure is taken (teeth, the
  /// roller of a cam), has all that acts here: one entry for each body, the ground too, and point.
  std::vector<BodyForce> parts{};

  bool of_stop() const { return stop >= 0; }
};

/// The reaction of a stop, an index of Scene::stops; null where it does not act.
const Reaction* reaction_of_stop(const std::vector<Reaction>& reactions, std::size_t stop);

/// Size of a resultant force, N, and its proved distance from the exact one; infinite where nothing is proved.
struct Resultant {
  double force = 0.0, radius = 0.0;
};

/// Resultant of the forces of so many stops from the first on; 0 where none of them acts.
Resultant resultant_of_stops(const std::vector<Reaction>& reactions, std::size_t first, std::size_t count);

/// Static force T of an element, N or N m, positive where it tends to reduce its measure, and its proved distance from
/// the exact one.
struct ElementForce {
  double value = 0.0;
  double radius = std::numeric_limits<double>::infinity();
};

/// Bounds within which free-body statics calls a pose an equilibrium.
struct CheckTolerances {
  double closure = 1e-9;    ///< largest gap of a joint / size of the mechanism
  double imbalance = 1e-9;  ///< largest unbalanced force, or moment / size, of a body / largest force on any body
  double stop = 1e-8;       ///< stop overrun, rad or / size
};

/// Result of free-body statics, a second opinion beside the certificate: other mechanics, in other code, in double.
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
  /// Every rope that carries a force lies on all of its pulleys, and every rolling wheel is pressed to its line or
  /// circle.
  bool keeps_contacts = false;
  std::vector<Reaction> reactions;
  std::vector<ElementForce> element_forces;  ///< per element of the scene
  int redundancy = 0;  ///< number of independent states of self-stress (degree of static indeterminacy)

  /// Closed, balanced, within its stops, on its pulleys and with its wheels on what they roll on.
  bool is_equilibrium() const { return closed && balanced && stops_kept && keeps_contacts; }
  /// Why it is not an equilibrium, one sentence; empty if it is.
  std::string objection;
  /// Stops (indices of Scene::stops) that would have to pull, so that they are left alone where a search goes on.
  std::vector<int> pulling;
};

/// Checks the scaled coordinates x of a model by vector statics:
///
/// closure    every joint of the scene, measured between the poses of its two bodies
/// balance    each body cut free under its loads and the reactions of its joints; the reactions are the least-squares
///            solution of all bodies' 3 equations, so what they cannot balance remains as imbalance
///
/// `active`: the stops that act (indices of Scene::stops), for example those of a certificate; without it those that x
/// touches. On the side at which it touches, a stop pushes only: the reactions are those of balance() of
/// statics/free_bodies.hpp, and where bodies could balance only if one pulled, that is the objection.
///
/// `sharing`: stops at their limit that may take a part of the load of active ones.
Check check(const StaticModel& model, const std::vector<double>& x, const CheckTolerances& tolerances = {},
            const std::vector<int>* active = nullptr, const std::vector<int>& sharing = {});

}  // namespace poise
