#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "statics/equilibrium/equilibrium.hpp"

namespace poise {

// Internal loads of links that have a section (model/cross_section.hpp), by beam theory on the link as it stands in an
// equilibrium: a rigid link in its own shape, a flexible one (model/flexible_link.hpp) as it is bent. s runs along the
// line of the section, t is its direction and n that direction turned a quarter counter-clockwise, to the left. With G
// the sum of all forces on the part of the link before a cut and m their moment about it (both counter-clockwise
// positive):
//
//   N = -G . t    normal force, tension positive
//   V =  G . n    shear force,  V = dM/ds
//   M = -m        bending moment, positive where the line bends to the left: it stretches the fibres on the right
//
//   stress      N/A - M e_left / I  in the extreme fibre on the left,  N/A + M e_right / I  on the right
//   curvature   M / (E I)  (Euler and Bernoulli, small deflections, bending only)
//
// All vectors of a rigid link are in the frame of its body, those of a flexible one in the world.

/// What acts on a link at one place of its line.
struct LinkAction {
  std::string name;     ///< "pin A", "force P", "weight"
  double s = 0.0;       ///< m
  Vec2 force{};         ///< N
  double moment = 0.0;  ///< N m, about the point of the line
  double arm = 0.0;     ///< m: how far from the line it acts, through a rigid arm at the nearest point; 0 on the line
};

/// What acts along a straight part of the line: per_length + (s - from) slope.
struct LineAction {
  std::string name;
  double from = 0.0, to = 0.0;  ///< s, m
  Vec2 per_length{};            ///< N/m
  Vec2 slope{};                 ///< N/m^2; 0 of all but inertia

  Vec2 whole() const { return (to - from) * (per_length + (0.5 * (to - from)) * slope); }
};

/// What is inside of a link, and what becomes of it, at one place.
struct LinkState {
  double normal = 0.0, shear = 0.0, moment = 0.0;  ///< N, N, N m
  double stress_left = 0.0, stress_right = 0.0;    ///< N/m^2, in the extreme fibres
  Vec2 at{}, deflection{};                         ///< m: of the line, and its displacement
  double turn = 0.0;                               ///< rad: of the line's direction
};

/// A straight part of the line on which nothing but even loads, and inertia, acts. x = s - from; all values at x = 0.
struct LinkPiece {
  double from = 0.0, to = 0.0;  ///< s, m
  Vec2 at{}, along{};           ///< place, m, and direction t
  double normal = 0.0, shear = 0.0, moment = 0.0;
  double normal_slope = 0.0, shear_slope = 0.0;  ///< N/m
  double normal_bend = 0.0, shear_bend = 0.0;    ///< N/m^2: second derivatives
  double turn = 0.0;
  Vec2 deflection{};
};

/// The state at one place of a link, behind what acts there.
struct LinkSample {
  double s = 0.0;  ///< m
  Vec2 along{};    ///< direction t
  LinkState state;
};

/// The value that is largest by size, and where.
struct LargestOnLink {
  double value = 0.0, s = 0.0;
};

/// The internal loads of one link.
struct LinkLoads {
  std::string name;
  int frame = 0;  ///< body in whose frame all vectors are; the ground of a flexible link
  bool flexible = false;
  CrossSection section;
  /// Why nothing is said of this link: one sentence. Then all that follows is empty.
  std::string why;
  double length = 0.0;  ///< of the line, m
  double spread = 0.0;  ///< kg: of a link in motion, the mass along its line; the rest is at the centre of mass
  std::vector<LinkAction> actions;
  std::vector<LineAction> line_actions;
  std::vector<LinkPiece> pieces;  ///< of a rigid link
  /// Of a flexible link, at the ends and the three points of Gauss of each element. M at the latter is that of the
  /// springs; from there to the ends V is integrated.
  std::vector<LinkSample> samples;
  LargestOnLink normal, shear, moment;
  LargestOnLink tension, compression;  ///< largest and smallest stress, N/m^2
  /// The displacement of the line, in size, where its two ends stay on the line through both of them and the first
  /// stays in its place (of a line that ends where it begins: where the first end does not turn), m, from bending
  /// alone. Of a rigid link, as all that follows.
  LargestOnLink deflection;
  double turn_first = 0.0, turn_last = 0.0;  ///< rad: of the two ends, against that line
  /// Of a link that only two forces act on, at joints that let it turn, and that they compress: Euler's load
  /// pi^2 E I / l^2 between them, over the compression. Empty otherwise.
  std::optional<double> buckling_factor;
  /// What is left of force, or moment over length, behind the end of the line, over the largest force on the link: the
  /// sum of all that acts, which must vanish, found along the line.
  double imbalance = 0.0;

  /// The largest size of the stress, N/m^2.
  double stress() const { return std::max(tension.value, -compression.value); }
  /// Inside of a piece, s within it.
  LinkState at(const LinkPiece& piece, double s) const;
  /// Returns the state of a rigid link at the place of its line that is nearest to a point of the body, m, before what
  /// acts there; none where nothing is said of the link.
  std::optional<LinkState> at_nearest(Vec2 point) const;
  /// So many parts of every piece; all samples of a flexible link.
  std::vector<LinkSample> sampled(int parts) const;
};

/// How the frame of a body is accelerated, in the world.
struct BodyAcceleration {
  Vec2 of_origin{};      ///< m/s^2
  double rate = 0.0;     ///< rad/s
  double turning = 0.0;  ///< rad/s^2
};

/// The effort of a drive, N or N m, positive where it tends to increase the measure.
struct MeasureEffort {
  std::string name;
  Measure on;
  double value = 0.0;
};

/// All forces on bodies in motion, and that motion.
struct ForcesInMotion {
  std::vector<double> element_forces;  ///< N or N m, per element: positive if it tends to reduce its measure
  std::vector<Reaction> reactions;
  std::vector<MeasureEffort> efforts;
  std::vector<BodyAcceleration> accelerations;  ///< per body of the scene
  /// False of a state beside a motion, whose forces need not balance: loads are then those of the parts before the
  /// cuts.
  bool balanced = true;
};

/// Whether a scene has links with a section.
bool has_links(const Scene& scene);

/// The internal loads of all links with a section, the rigid ones first, in an equilibrium at `poses` (SI, of all
/// bodies) whose joint forces are those of `check`. Nothing is said of a link where statics does not determine a joint
/// force, where three joints or more are not all on its line, where a distributed load leaves the line, where a moment
/// enters it at no known place, or where the sum along the line does not vanish.
std::vector<LinkLoads> link_loads(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Check& check);

/// The same of bodies in motion, by d'Alembert's principle: each part of a link carries its weight and the inertia
/// force
/// - dm a. Of a rigid link of mass m and moment of inertia I about its centre of mass, whose line of length l has the
/// radius of gyration k about its middle, the mass is taken
///
///   spread evenly along the line, m_s = min(m, I / k^2), where the centre of mass is the middle of the line, and
///   as a mass m - m_s with the moment of inertia I - m_s k^2 at the centre of mass, which is rigidly attached to the
///   nearest place of the line; all of it where the centre of mass is not the middle
///
/// so that mass, centre and moment of inertia are those of the body. With a the acceleration of a place, linear along
/// each straight part, N and V are quadratic there and M is cubic. Of a flexible link the mass is along its line; M at
/// the points of Gauss is that of its springs.
std::vector<LinkLoads> link_loads(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                  const ForcesInMotion& forces);

/// Where internal loads are wanted: the equilibrium that solve() finds, or, where nothing can move (a structure), the
/// pose in which the joints close. Throws InputError where loops cannot be closed.
Equilibrium solve_or_hold(const StaticModel& model, const SolveOptions& options = {});

}  // namespace poise
