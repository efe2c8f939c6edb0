#pragma once

#include <string>
#include <vector>

#include "statics/static_model.hpp"

namespace poise {

/// Motions along which no load does work, whatever the pose, of a mechanism in which nothing else resists them: turning
/// a frame that is balanced about its joint, together with frames whose springs tie them to it, or sliding where
/// nothing pushes. With one equilibrium every pose that such motions lead to is one.
struct NeutralMotions {
  struct Motion {
    std::vector<int> coordinates;  ///< angles that turn together, or one length; the first is `held`
    int held = -1;                 ///< coordinate that takes the motion away when it is held
    /// No closure, spring, load or stop tells its values apart: the work is zero where the numbers of the scene, as
    /// the decimals in which they are written, are taken exactly; else it is zero but for rounding.
    bool exact = false;
    /// Where it is not exact: bound of the torque (N m) or force (N) along the motion in every pose, for all numbers
    /// that round to those of the scene.
    double effort = 0.0;
  };
  std::vector<Motion> motions;

  bool any() const { return !motions.empty(); }
  /// x moved along the motions to where the held coordinates have the values of `at`.
  std::vector<double> moved_to(const std::vector<double>& at, std::vector<double> x) const;
};

/// Proved by the coefficients of the energy as a sum of products of phasors (statics/merged_energy.hpp): a motion is
/// neutral where those that it changes vanish, in rational numbers or within the rounding of the scene's numbers.
/// `start` is between the stops that act on such angles alone, which no equilibrium needs then.
NeutralMotions neutral_motions(const StaticModel& model, const std::vector<double>& start);

/// The scene with these motions held at x, and without stops that limit them.
Scene with_motions_held(const StaticModel& model, const NeutralMotions& neutral, const std::vector<double>& x);

}  // namespace poise
