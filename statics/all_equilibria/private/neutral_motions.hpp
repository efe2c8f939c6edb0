#pragma once

#include <optional>
#include <string>
#include <vector>

#include "statics/all_equilibria/private/merged_energy.hpp"
#include "statics/all_equilibria/private/turning_branch.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// Motions along which no load does work, whatever the pose, of a mechanism in which nothing else resists them: turning
/// a frame that is balanced about its joint, together with frames whose springs tie them to it, or sliding where
/// nothing pushes. With one equilibrium every pose that such motions lead to is one.
struct NeutralMotions {
  struct Motion {
    std::vector<int> coordinates;  ///< angles that turn together, or one length; the first is `fixed`
    int fixed = -1;                ///< coordinate that takes the motion away when it is fixed
    bool is_fixed_by_body = true;  ///< a measure of the scene can fix it
    /// No closure, spring, load or stop tells its values apart: the work is zero where the numbers of the scene, as
    /// the decimals in which they are written, are taken exactly; else it is zero but for rounding.
    bool exact = false;
    /// Where it is not exact: bound of the torque (N m) or force (N) along the motion in every pose, for all numbers
    /// that round to those of the scene.
    double effort = 0.0;
  };
  std::vector<Motion> motions;
  /// Loops in which these motions turn bodies together (statics/all_equilibria/private/turning_branch.hpp): they are
  /// neutral on that branch, but for its change points, and of others nothing is said. All its groups belong to
  /// motions.
  std::optional<TurningBranch> branch;
  /// With a branch: the part of the energy that motions change, for all numbers that round to those of the scene.
  std::vector<MergedEnergy<Interval>::Product> products;

  bool any() const { return !motions.empty(); }
  /// Whether the motions lead to every pose of a mechanism with so many coordinates, or of the branch.
  bool lead_everywhere(int coordinates) const;
  /// Whether a closed pose is one that they are neutral in, up to 1e-6 rad.
  bool contain(const std::vector<double>& x) const;
  /// x moved along the motions to where the fixed coordinates have the values of `at`; of other branches as it is.
  std::vector<double> moved_to(const std::vector<double>& at, std::vector<double> x) const;
};

/// Proved by the coefficients of the energy as a sum of products of phasors
/// (statics/all_equilibria/private/merged_energy.hpp): a motion is neutral where those that it changes vanish, in
/// rational numbers or within the rounding of the scene's numbers. Where loops close, coefficients of bodies that turn
/// together are added up first. `start` is closed, and between the stops that act on such angles alone, which no
/// equilibrium needs then.
NeutralMotions neutral_motions(const StaticModel& model, const std::vector<double>& start);

/// The scene with these motions fixed at x, and without stops that limit them.
Scene with_motions_fixed(const StaticModel& model, const NeutralMotions& neutral, const std::vector<double>& x);

}  // namespace poise
