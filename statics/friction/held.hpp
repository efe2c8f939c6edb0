#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/measure.hpp"
#include "statics/bodies/forces_on_bodies.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

// Poses that friction holds. A pose is held if there are friction efforts f within their bounds and joint forces R with
// which every body, cut free, is in balance:
//
//   A R + B f = -load,   |f_i| <= k bound_i(R),   k = 1
//
// with the bounds of JointFriction, and |f_i| <= force of a [[friction]] on a measure; stops that touch push only.
// Bounds grow with the joint forces, so that the set of f and R is not convex: it is a union of convex parts, one for
// each choice of the sign of a normal force (or of the couple) and of the direction of the force in a pin. Cases of
// these are searched, sectors of directions halved where needed; each is a linear program. docs/friction.md.

// A rope on the rims of its pulleys has the tensions of its parts, and between those before and behind a pulley
//
//   T_behind <= exp(k mu w) T_before,   T_before <= exp(k mu w) T_behind,
//
// w the angle of its wrap: k multiplies the coefficient.

/// Whether anything in a scene rubs: joints with friction, [[friction]] elements, ropes on pulleys with friction.
bool has_friction(const Scene& scene);

/// A joint or [[friction]] that rubs, or a rope on a pulley.
struct Rubbing {
  std::string name;       ///< of a rope with that of the pulley: "r on drum.O"
  std::string_view kind;  ///< "pin", "slide", "pin_in_slot", "friction", "rope"
  Measure on;             ///< what changes where it slips; of a rope its length, which does not: it runs over the rim
  int joint = -1, element = -1;  ///< index of Scene::joints or Scene::elements
  int rope = -1, contact = -1;   ///< index of Scene::stops, and of Measure::contacts
};
std::vector<Rubbing> rubbing(const Scene& scene);

/// One that slips: index of rubbing(), and whether its measure increases; of a rope whether it runs towards its last
/// point.
struct Slip {
  std::size_t of = 0;
  bool increases = false;
};

/// Friction effort f, N or N m, positive where it tends to increase the measure, and its bound. Of a rope the force of
/// the rim, positive towards its last point: the tension before the pulley less that behind it; the bound is the less
/// of the two times exp(mu w) - 1.
struct FrictionEffort {
  double effort = 0.0;
  double bound = 0.0;
};

enum class Holding { held, slips, not_decided };

struct HeldPose {
  Holding verdict = Holding::not_decided;
  /// The verdict is proved in ball arithmetic, for the places of the bodies to within rounding.
  bool proved = false;
  std::string why;  ///< where it is not decided
  /// The least k for which the pose is held, by which all bounds of friction might be multiplied: 0 where it is an
  /// equilibrium without friction, infinite where no k holds it.
  double least_factor = std::numeric_limits<double>::quiet_NaN();
  /// Proved: held at the upper, not at the lower; not numbers where that could not be proved.
  double factor_lower = std::numeric_limits<double>::quiet_NaN();
  double factor_upper = std::numeric_limits<double>::quiet_NaN();
  /// Of each of rubbing(), at the least factor: efforts that balance the bodies, and bounds at k = 1.
  std::vector<FrictionEffort> efforts;
  /// All that acts on the bodies with them, the ground too; empty where there are no efforts.
  std::vector<SourcedForce> on_bodies;
  /// What slips where k falls below the least factor.
  std::vector<Slip> slips;
};

/// Whether friction holds a model at scaled coordinates x.
HeldPose held_pose(const StaticModel& model, const std::vector<double>& x);

/// One end of a range in which a pose is held.
struct HeldEnd {
  double value = 0.0;       ///< SI; infinite where it is held however far the number goes
  bool at_limit = false;    ///< of the range asked for, or of what the number may be: held there
  bool proved = false;      ///< held and not held proved on both sides within `radius`, or without end
  double radius = 0.0;      ///< SI
  std::vector<Slip> slips;  ///< what slips beyond it
};

/// The values of one number, through the present one where that is held, for which the pose is held.
struct HeldRange {
  HeldPose now;
  bool any = false;           ///< there are such values
  bool contains_now = false;  ///< the present one is among them
  std::string why;            ///< where they could not be found
  double present = 0.0;       ///< SI
  HeldEnd lower, upper;
  /// The value that balances the mechanism without friction, SI, in double precision; none where there is none or more
  /// than one, and of a number of friction.
  std::optional<double> ideal{};
  /// Efficiency where the number, a load of one sign, drives the mechanism against all others at the edge of slipping:
  /// ideal / end of the range farther from 0. Where the others drive it against the number: end nearer to 0 / ideal,
  /// and 0 where friction locks it without a load (J. Shigley, C. Mischke, "Mechanical Engineering Design", section 8.2
  /// has those of screws). None without an ideal value other than 0 in the range.
  std::optional<double> efficiency() const;
  std::optional<double> efficiency_back() const;
};

/// Varies a number of the scene (a path of set_value(), or "loads": a factor of all forces and torques) between two
/// values, SI, -inf and inf for all that it may take (of the size of a force 0 and more; a negative one, where it is
/// asked for, acts in the opposite direction), with the bodies as they are at x. Throws InputError for a number
/// on which the pose depends, and for one that neither loads nor friction are affine in.
HeldRange held_range(const StaticModel& model, const std::vector<double>& x, const std::string& number,
                     double from = -std::numeric_limits<double>::infinity(),
                     double to = std::numeric_limits<double>::infinity());

}  // namespace poise
