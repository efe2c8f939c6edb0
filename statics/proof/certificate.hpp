#pragma once

#include <optional>
#include <string>
#include <vector>

#include "statics/model/static_model.hpp"
#include "statics/proof/stability.hpp"

namespace poise {

/// What is known of an answer.
enum class Outcome {
  /// Exactly one equilibrium lies within the radius, and its number of unstable directions is proved.
  proved,
  /// Along some coordinates the equations of equilibrium hold everywhere to within the rounding of the scene's own
  /// numbers; across them exactly one equilibrium lies within the radius for every value of those coordinates.
  neutral,
  /// Curvature vanishes within the radius (a fold or a cusp, a change point, a kink): see `stability`; if it is not
  /// unknown it is proved by the signs of the force on both sides.
  degenerate,
  no_equilibrium,  ///< none lies near
  not_proved       ///< nothing could be shown; `statement` says why
};

/// "proved", "neutral", ...
std::string to_string(Outcome outcome);

struct CertificateOptions {
  /// Largest distance from an answer to the equilibrium that it is refined to, rad or mechanism sizes.
  double farthest = 1e-3;
  /// Products of balls allowed, in those of 128 bits, for large mechanisms: about 10 s.
  double products = 1e8;
  std::optional<double> seconds{};  ///< time allowed in place of `products`, for a person who waits
};

/// A proof about an answer, of the scene as written: its numbers are taken as the exact doubles that they became.
///
/// With x the coordinates, y the multipliers of closures and active stops, the square system
///   F(x) + J(x)^T y = 0,  c(x) = 0,  g_s(x) = bound of active stop s
/// is solved by Newton's method in ball arithmetic. All its matrices of first derivatives within a box around the
/// refined point are proved regular (solvers/regular_set.hpp), so that the interval Newton operator, which maps the box
/// into itself, proves that the box contains exactly one solution (R. E. Moore, R. B. Kearfott, M. J. Cloud,
/// "Introduction to Interval Analysis", 2009, chapter 8). The number of negative eigenvalues of those symmetric
/// matrices is that of the reduced Hessian plus one for each row of J. Reactions of active stops and gaps of all others
/// are enclosed too. docs/certificate.md has the whole of it.
struct Certificate {
  Outcome outcome = Outcome::not_proved;
  std::string statement;  ///< one sentence

  std::vector<double> x;  ///< scaled coordinates: the middle of the enclosure, rounded to doubles
  double radius = 0.0;    ///< rad or mechanism sizes: every coordinate of the equilibrium is this close to x
  /// The enclosure to more digits: every coordinate is within `rest_radius` of x + rest, added exactly. Empty where
  /// nothing is proved, or where there is no such place because some closures hold to within rounding only.
  std::vector<double> rest;
  double rest_radius = 0.0;
  /// Mechanism sizes: the widest gap of joints that repeat others to rounding only, of which any may be open.
  double gap = 0.0;
  double moved = 0.0;  ///< largest distance of a coordinate from the answer given to x
  /// First-order bound on the change of a coordinate when every number of the scene changes by half a unit in its last
  /// place, rad or mechanism sizes: what the scene's own numbers leave open.
  double rounding_effect = 0.0;

  Stability stability = Stability::unknown;
  int unstable_directions = 0;
  int neutral_directions = 0;
  std::vector<std::string> neutral_coordinates;  ///< coordinates whose values are arbitrary
  std::vector<int> active_stops;                 ///< indices of Scene::stops
  /// Stops at their limit whose measure active ones already hold: how these share the load is not determined.
  std::vector<int> sharing_stops;
  /// Where stops share loads: those, active or sharing, without which no forces of the others balance the loads. It is
  /// proved of each of them that some motion leaves all others, and that the loads do work in it.
  std::vector<int> needed_stops;
  /// Every touched stop presses, and no one-way spring is exactly at its free length.
  bool strict = true;
  int redundant = 0;    ///< closure rows that repeat others
  bool locked = false;  ///< closures and stops leave no motion
  /// The closures lose rank and no finite joint forces balance the loads.
  bool singular = false;
  /// Proved where `singular`: every equilibrium within 1e-10 of the singular configuration needs a joint force of at
  /// least so much, N.
  double least_joint_force = 0.0;
  bool unfinished = false;  ///< what CertificateOptions allow was not enough

  /// An equilibrium is known to exist, and what is said of it is proved.
  bool confirmed() const {
    return outcome == Outcome::proved || outcome == Outcome::neutral ||
           (outcome == Outcome::degenerate && stability != Stability::unknown);
  }
};

/// Examines the answer x (scaled coordinates) of any method.
Certificate certify(const StaticModel& model, const std::vector<double>& x, const CertificateOptions& options = {});

}  // namespace poise
