#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "design/balance/balance_problem.hpp"

namespace poise {

/// Springs with real free lengths, which balance no weight in every pose: the stiffnesses for which the largest torque
/// that is left over a range of poses is least.
struct NearBalance {
  bool solved = false;
  Scene scene;                ///< with the stiffnesses found
  std::vector<double> found;  ///< SI
  /// Proved bounds of the least largest torque, N m, or force, N: the lower one of all stiffnesses within their ranges,
  /// the upper one of those found over the whole range.
  double lower = 0.0, upper = 0.0;
  bool is_force = false;
  std::vector<double> at;  ///< a pose in which it is reached, of the ranges of the problem, rad or m
  double reached = 0.0;    ///< there
  double without = 0.0;    ///< largest torque of the weights alone, upper bound
  int exchanges = 0, poses = 0, boxes = 0;
};

/// A linear program over finitely many poses, to which the worst pose of its solution is added until that is no worse
/// (exchange method: E. Ya. Remez 1934; R. Hettich, K. O. Kortanek, "Semi-infinite programming", SIAM Review 35, 1993).
/// Its dual bounds all stiffnesses from below (least_largest_torque), largest_torque() the result from above. Throws
/// InputError where a freedom of the mechanism has no range, loops other than parallelograms close, or points are
/// sought too.
NearBalance balance_nearly(const BalanceProblem& problem, const std::atomic<bool>* interrupt = nullptr);

}  // namespace poise
