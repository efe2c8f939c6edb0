#pragma once

#include <string>
#include <vector>

#include "motion/body_motion.hpp"
#include "motion/motion_model.hpp"
#include "statics/check.hpp"

namespace poise {

/// What a drive has to give.
struct DriveEffort {
  std::string name;
  bool is_angle = true;    ///< it drives an angle, else a length
  double value = 0.0;      ///< torque on its second body, N m, or force along the travel, N; the opposite on the first
  double rate = 0.0;       ///< of what it drives, rad/s or m/s
  double power = 0.0;      ///< W: value times rate
  bool determined = true;  ///< false: shared with other drives or reactions, the set of least norm
};

/// Power of everything that acts on a moving mechanism, W, from its phasor form.
struct PowerBalance {
  double kinetic = 0.0;    ///< d/dt of the kinetic energy
  double potential = 0.0;  ///< d/dt of the potential of weights, dead loads and springs, less what followers give
  double resisted = 0.0;   ///< taken by dampers and dry friction
  double driven = 0.0;     ///< given by the drives
  /// |kinetic + potential + resisted - driven| over driven power plus largest force times the fastest rate; 0 where
  /// nothing moves.
  double error = 0.0;
};

/// All forces in a mechanism that moves in a given way. SI.
struct Forces {
  std::vector<BodyMotion> motions;  ///< of all bodies, then of all bars
  std::vector<DriveEffort> drives;
  std::vector<Reaction> reactions;  ///< of joints, bars and pressing stops
  /// T of every element of the scene, N or N m: positive where it tends to diminish its measure.
  std::vector<double> element_force;
  std::vector<std::string> idle_stops;  ///< touched, but the drives alone decide what they limit and carry it all
  std::vector<double> overrun;          ///< per stop, rad or m: how far the pose is beyond it; 0 where it is not
  int redundancy = 0;                   ///< independent sets of reactions and drive efforts that balance nothing

  double imbalance = 0.0;  ///< N: largest force, or moment / size, that neither reactions nor drives can take up
  std::string worst_body;
  double largest_force = 0.0;  ///< N
  bool balanced = false;       ///< imbalance below 1e-9 of the largest force
  /// How far the given rates and accelerations open the loops: over the largest rate (acceleration) of a phasor.
  double loop_error = 0.0;
  PowerBalance power;
  /// Largest generalized force, over largest_force times size, that the phasor model says is left along a direction
  /// in which the mechanism can move. Shares only M(q) and the loads' data with the free bodies.
  double work_error = 0.0;
};

/// A force element in parallel with a drive: what it carries depends on nothing but the quantity that is driven, so
/// that the drive bears the mechanism's load and exactly that.
struct ParallelElement {
  std::size_t element = 0;  ///< index into Scene::elements
  std::string drive;
};

/// Those upon the relative angle that a drive turns; upon the travel that it moves; upon a distance between the bodies
/// of a driven slide, or between points that pins and welds keep at the two points of a driven joint.
std::vector<ParallelElement> parallel_elements(const MotionModel& model, const std::vector<Drive>& drives);

/// Inverse dynamics by d'Alembert's principle: every body cut free under its loads, springs, dampers, friction and
///   -m p''  at its centre of mass,  -I theta''  about it,
/// for scaled coordinates x of the model, their rates v (per s) and accelerations a (per s^2), which must keep the
/// loops closed. Reactions and the efforts of `drives` are the least-squares solution of all bodies' 3 equations, the
/// one of minimum norm where it is not unique. With v = a = 0 this is static force analysis at a given pose. Time laws
/// of the drives play no part, only what they act on.
///
/// A stop that is touched may press, unless drives alone decide what it limits: grad g . v is a sum of the drives'
/// rates for every v with J v = 0. Balance would leave open what drive and stop then share; the drives carry all of it.
Forces forces_of(const MotionModel& model, const std::vector<double>& x, const std::vector<double>& v,
                 const std::vector<double>& a, const std::vector<Drive>& drives);

}  // namespace poise
