#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "tests/judge/exact_mechanics.hpp"

namespace poise::judge {

/// Of an equilibrium. `unknown` of loads that follow a body: no divergence, and statics cannot exclude flutter.
enum class Kind { unknown, stable, unstable, neutral };

/// What a coordinate of an answer is in the scene: the angle of a body or of a bar, the travel of a joint, or x or y of
/// the origin of a body; rad or m.
struct ClaimedCoordinate {
  enum class Of { angle, bar, travel, x, y };
  Of of = Of::angle;
  int item = 0;         ///< body or joint
  double value = 0.0;   ///< from `origin`
  double origin = 0.0;  ///< of x and y, m
};

/// An answer as its program states it.
struct Claim {
  bool confirmed = false;
  Kind kind = Kind::unknown;
  bool neutral = false;            ///< along some freedom, whatever its kind is across
  std::optional<double> radius{};  ///< within which the equilibrium is said to be, rad or `size`
  bool minimum_sought = false;     ///< an unstable equilibrium is then rightly not confirmed
  /// Poses of all bodies, m and rad: where the judge starts.
  std::vector<Vec2> origins;
  std::vector<double> angles;
  std::vector<ClaimedCoordinate> coordinates;  ///< by which distances are measured
};

enum class Verdict {
  right,           ///< confirmed: an equilibrium of that kind is within the radius; or not confirmed for a good reason
  no_equilibrium,  ///< confirmed, and there is none within `near` of the answer
  outside_radius,  ///< confirmed, the equilibrium is farther than the radius
  wrong_kind,      ///< confirmed, and the equilibria within the radius are of other kinds
  lost,            ///< not confirmed, although isolated, of condition below 1e10 and within `near`
  undecided        ///< the judge cannot say; `why` says why
};

std::string to_string(Kind kind);
std::string to_string(Verdict verdict);
/// Whether it is one of the three false claims.
bool is_false(Verdict verdict);

/// An exact equilibrium.
struct Truth {
  Kind kind = Kind::unknown;
  bool decided = true;        ///< its kind is
  bool also_neutral = false;  ///< the force along some freedom is zero to the rounding of the scene's numbers
  double distance = 0.0;      ///< largest of the claimed coordinates, rad or `size`
  double allowance = 0.0;     ///< by which redundant joints, which agree only to rounding, leave its place open
  double condition = std::numeric_limits<double>::infinity();
  bool strict = true;  ///< every stop in contact has a force, no one-way spring is at its free length
  /// Undecided only because springs are at their free length to rounding: `kind` is that exactly at it.
  bool at_free_length = false;
  bool exact = true;  ///< stops and one-way springs are as they must be exactly, not only to rounding
  int negative = 0;   ///< negative curvatures; of loads that follow a body 1 for a negative determinant
  std::string note;
};

struct Judgement {
  Verdict verdict = Verdict::undecided;
  std::optional<Truth> truth;  ///< the equilibrium the verdict is about
  std::string why;
};

/// Judges answers for one scene in 50 digits by mechanics of its own (ExactMechanics): Newton's method from the answer
/// on every piece that stops and one-way springs leave possible there, and where it finds nothing, a search along the
/// softest freedom. Where closures lose rank (change points) the branches are judged by second derivatives.
class Judge {
 public:
  /// Within this distance, rad or `size`, an answer without or with a wrong radius is compared with an equilibrium.
  static constexpr double near = 1e-5;

  /// `size`, m, a power of two, is the unit of radii.
  Judge(const Scene& scene, double size) : mechanics_(scene, size) {}

  Judgement judge(const Claim& claim) const;
  /// Equilibria found near the answer, nearest first. `trouble` is not empty if there might be others.
  std::vector<Truth> equilibria(const Claim& claim, std::string& trouble) const;

 private:
  ExactMechanics mechanics_;
};

}  // namespace poise::judge
