#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "model/planar.hpp"

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
  std::string kind;  ///< "pin", "slide", "pin_in_slot", "weld", "bar", "blade", "drive", or the table of a stop:
                     ///< "stop", "gear", ...
  int joint = -1;    ///< index in Scene::joints; -1 of a stop or drive
  int stop = -1;     ///< index in Scene::stops; -1 of a joint, bar or drive
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
  /// nothing is proved (statics/proof/enclosed_reactions.hpp).
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

}  // namespace poise
