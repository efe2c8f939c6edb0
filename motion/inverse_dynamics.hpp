#pragma once

#include <string>
#include <vector>

#include "motion/body_motion.hpp"
#include "motion/motion_model.hpp"
#include "motion/sliding_friction.hpp"
#include "statics/bodies/forces_on_bodies.hpp"
#include "statics/bodies/reaction.hpp"

namespace poise {

/// Required effort of a drive.
struct DriveEffort {
  std::string name;
  bool is_angle = true;  ///< it drives an angle, otherwise a length
  double value = 0.0;    ///< torque on its second body, N m, or force along the travel, N; the opposite on the first
  double rate = 0.0;     ///< of the driven quantity, rad/s or m/s
  double power = 0.0;    ///< W: value times rate
  bool determined =
      true;  ///< false: statically indeterminate, shared with other drives or reactions; the set of minimum norm
};

/// Power balance of a moving mechanism, W, from its phasor form.
struct PowerBalance {
  double kinetic = 0.0;  ///< d/dt of the kinetic energy
  double potential =
      0.0;  ///< d/dt of the potential of weights, dead loads and springs, minus the power of follower loads
  double resisted = 0.0;  ///< dissipated by dampers and dry friction
  double rubbed = 0.0;    ///< dissipated by friction of joints
  double driven = 0.0;    ///< supplied by the drives
  /// |kinetic + potential + resisted + rubbed - driven| over driven power plus largest force times the fastest rate; 0
  /// if nothing moves.
  double error = 0.0;
};

/// A stop that would have to pull, though it can only push.
struct PullingStop {
  std::size_t stop = 0;  ///< index into Scene::stops
  bool at_max = false;   ///< or at its min
};

/// All forces in a mechanism with a given motion. SI.
struct Forces {
  std::vector<BodyMotion> motions;  ///< of all bodies, then of all bars
  std::vector<DriveEffort> drives;
  std::vector<Reaction> reactions;  ///< of joints, bars and active stops
  /// Friction of joints. Where it is solved all forces here are those with it; otherwise they are without, and
  /// friction.has_no_forces() says that they are none of the mechanism's.
  SlidingFriction friction;
  /// T of every element of the scene, N or N m: positive if it tends to reduce its measure.
  std::vector<double> element_force;
  std::vector<std::string>
      idle_stops;  ///< touched, but on a measure that the drives determine, so that the drives carry the load
  /// Touched stops without whose pull the bodies would not balance. All forces here are those with it.
  std::vector<PullingStop> pulling;
  std::vector<double> overrun;  ///< per stop, rad or m: overrun of the pose, 0 if within it
  int redundancy = 0;           ///< number of independent self-equilibrating sets of reactions and drive efforts

  double imbalance = 0.0;  ///< N: largest force, or moment / size, that neither reactions nor drives balance
  std::string worst_body;
  double largest_force = 0.0;  ///< N
  bool balanced = false;       ///< imbalance below 1e-9 of the largest force, and no stop pulls
  /// Rate and acceleration at which the given motion opens the loops, relative to the largest rate (acceleration) of a
  /// phasor.
  double loop_error = 0.0;
  PowerBalance power;
  /// Largest unbalanced generalized force, over largest_force times size, along a direction in which the mechanism can
  /// move, by virtual work in the phasor model. Shares only M(q) and the loads' data with the free bodies.
  double work_error = 0.0;
};

/// A force element in parallel with a drive: its force depends on the driven quantity only, so that the drive carries
/// the mechanism's load plus the element's force.
struct ParallelElement {
  std::size_t element = 0;  ///< index into Scene::elements
  std::string drive;
};

/// Elements on the relative angle that a drive turns; on the travel that it moves; on a distance between the bodies of
/// a driven slide, or between points that pins and welds keep at the two points of a driven joint; on the same points
/// as a driven distance, place, component or rope.
std::vector<ParallelElement> parallel_elements(const MotionModel& model, const std::vector<Drive>& drives);

/// Inverse dynamics by d'Alembert's principle: every body cut free under its loads, springs, dampers, friction and
///   -m p''  at its centre of mass,  -I theta''  about it,
/// for scaled coordinates x of the model, their rates v (per s) and accelerations a (per s^2), which must keep the
/// loops closed. Reactions and the efforts of `drives` are the least-squares solution of all bodies' 3 equations, of
/// minimum norm if it is not unique. Joints with friction resist in the direction of their rates
/// (sliding_friction.hpp). With v = a = 0 this is static force analysis at a given pose. Only the measures that the
/// drives act on count, not their time laws.
///
/// A touched stop may carry a reaction, unless its measure is determined by the drives: grad g . v is a linear
/// combination of the drives' rates for every v with J v = 0. The shares of drive and stop would be indeterminate; the
/// drives carry all of it.
Forces forces_of(const MotionModel& model, const std::vector<double>& x, const std::vector<double>& v,
                 const std::vector<double>& a, const std::vector<Drive>& drives);

/// Everything that acts on the bodies, the ground too: that of statics/bodies/forces_on_bodies.hpp, with the drives,
/// friction of joints and inertia, m a and I alpha with the opposite signs. `scene` has the loads of the instant.
std::vector<SourcedForce> forces_on_bodies(const Scene& scene, const Forces& forces);

}  // namespace poise
