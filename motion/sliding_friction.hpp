#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion/body_motion.hpp"
#include "statics/bodies/free_bodies.hpp"

namespace poise {

// Friction of joints (JointFriction) in a mechanism with a given motion. A joint that moves at the rate w resists with
// its full bound, which depends on the force R in it,
//
//   f_i = -sign(w_i) bound_i(R),   R = R_0 + sum f_j R_j,
//
// where the joint forces R_0 without friction and those of unit efforts, R_j, come from the bodies cut free, with teeth
// that push their wheels apart by |Q| S, Q = Q_0 + sum f_j Q_j their effort, added to R. These are as many equations as
// joints that move, solved by Newton's method for g = |f|:  g = B(g). Where the matrix of the Lipschitz constants of B
// has a spectral radius below 1, B is a contraction: there is one solution and no other. Beyond that friction may lock
// the motion, or leave several possibilities; all solutions are found (FrictionForces).

/// A joint with friction that moves.
struct SlidingJoint {
  int joint = 0;        ///< index into Scene::joints
  Measure on;           ///< its angle or travel
  double rate = 0.0;    ///< of it, rad/s or m/s
  double effort = 0.0;  ///< N m or N, positive where it tends to increase the angle or travel: against the rate
  double bound = 0.0;   ///< of the joint forces found, which the size of the effort equals

  double lost() const { return -effort * rate; }  ///< W, not negative
};

/// Friction across a stop that is touched.
struct SlidingStop {
  int stop = 0;         ///< index into Scene::stops
  Measure on;           ///< its tangent
  double rate = 0.0;    ///< of it, m/s
  double effort = 0.0;  ///< N, positive where it tends to increase the tangent: against the rate

  double lost() const { return -effort * rate; }  ///< W, not negative
};

struct SlidingFriction {
  enum class State {
    none,          ///< the scene has no joint with friction
    still,         ///< nothing moves: friction may act either way and is left out
    solved,        ///< the forces are those with friction
    locked,        ///< no finite efforts of the drives move it in this direction
    several,       ///< more than one set of forces satisfies the equations, where friction may also lock
    undetermined,  ///< a bound depends on a joint force that statics does not determine
    unbalanced     ///< the bodies are out of balance without friction already
  };
  State state = State::none;
  std::vector<SlidingJoint> joints;  ///< those that move; efforts and bounds only where solved
  std::vector<SlidingStop> stops{};  ///< of a motion that takes place
  /// Joints with friction that stand still in this pose: which way they resist is not known, and they are taken to have
  /// no friction.
  std::vector<int> at_rest;
  int because_of = -1;   ///< undetermined: that joint
  double lock_at = 0.0;  ///< locked: the share of the friction up to which the motion can be followed from none on
  /// Efforts of the drives without any friction, neither of joints nor [[friction]], N m or N, and their power, W.
  std::vector<double> efforts_without;
  double driven_without = 0.0;
  double lost_in_joints = 0.0, lost_in_elements = 0.0;  ///< W; elements: [[friction]]

  bool has_no_forces() const {
    return state == State::locked || state == State::several || state == State::undetermined ||
           state == State::unbalanced;
  }
  double lost() const { return lost_in_joints + lost_in_elements; }
  /// Where the drives do work without friction: that power over the power with friction, which is more by what friction
  /// loses: P_0 / (P_0 + lost). None where they do not, or where it is not solved.
  std::optional<double> efficiency() const;
  /// Where the motion drives the drives, P_0 < 0: the power that arrives at them over what would without friction,
  /// (|P_0| - lost) / |P_0|; 0 where nothing arrives, so that they must help: it would stop by itself.
  std::optional<double> efficiency_back() const;
};

/// What sliding_friction() is asked about.
struct SlidingProblem {
  const Scene& scene;
  const std::vector<BodyMotion>& motions;  ///< of all bodies, measured as the additions
  const std::vector<int>& sides;           ///< of stops, as for balance()
  double size = 1.0;                       ///< m
  const Additions& additions;              ///< inertia, resistance of elements, drives
  double fastest = 0.0;                    ///< rad/s or sizes/s: rates below 1e-9 of it are none
};

/// Friction of joints and the bodies with it; where no forces with friction are found, those without.
struct Slid {
  SlidingFriction friction;
  FreeBodies bodies;
};

/// Finds them. `lost_in_elements`, `efforts_without` and `driven_without` are left to the caller.
Slid sliding_friction(const SlidingProblem& problem);

/// What a joint resists with at most under this reaction, N m or N (JointFriction).
double friction_bound(const Joint& joint, const Reaction& reaction);

}  // namespace poise
