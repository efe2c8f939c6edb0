#pragma once

#include <string>
#include <vector>

#include "design/balance/balance_problem.hpp"
#include "design/balance/energy_terms.hpp"
#include "design/balance/pose_form.hpp"

namespace poise {

/// One function of the pose in the energy, N m (lengths in sizes of the mechanism).
struct EnergyTerm {
  std::string name;
  double weights = 0.0;            ///< coefficient that weights, dead loads and springs that are given have
  double springs = 0.0;            ///< that of the springs that are found
  double multiplier = 0.0;         ///< where it cannot be cancelled: in the sum that is refuted
  double least = 0.0, most = 0.0;  ///< what the springs that are sought can give, within the ranges
};

/// The general statics of the scene with the numbers found, in random poses.
struct PosesChecked {
  int poses = 0;
  double imbalance = 0.0;  ///< largest unbalanced force, or moment / size, of a body, N
  double weight = 0.0;     ///< sum of the sizes of weights and dead loads, N
};

/// Springs that balance weights in every pose.
///
/// Potentials of weights, of dead loads, and of linear springs of free length zero between points (k/2 |b - a|^2) are
/// sums of constants times cosines and sines of the bodies' angles and of their differences, times travels (energy
/// terms). The whole is constant, and every pose an equilibrium, where all coefficients vanish: equations that are
/// linear in the stiffnesses, and in coordinates of one end of a spring. Of a spring with an unknown stiffness and
/// unknown coordinates c of one end the products k c are unknowns, within k min <= k c <= k max: linear too. Of several
/// solutions the one with the least sum of the stiffnesses is taken.
struct WeightBalance {
  bool balanced = false;
  Scene scene;                ///< with the numbers found
  std::vector<double> found;  ///< SI, of the stiffnesses, then of the coordinates of the problem
  std::vector<EnergyTerm> terms;
  double residual = 0.0;  ///< largest coefficient that is left, over the largest of the weights
  int closures = 0, relations = 0, parallelograms = 0;
  bool complete = true;  ///< FunctionSpace::is_complete()
  bool refuted = false;  ///< of those that cannot be balanced: the multipliers prove it
  double demand = 0.0, most = 0.0;
  int row = -1;  ///< the term that alone cannot be cancelled
  PosesChecked check;
};

/// Throws InputError where the scene has loads or springs that are no such sums.
WeightBalance balance_weights(const BalanceProblem& problem);

/// Whether all springs that act, and those that are sought, have a place in an exact balance: no free length.
bool may_be_exact(const BalanceProblem& problem);

/// Whether a spring between two points has no free length: its force is proportional to its length.
bool has_no_free_length(const Element& element);

/// Loads that have a potential at a place that moves: weights and dead loads, N.
struct PlacedLoad {
  std::string name;
  PhasorTerms place;
  Vec2 force;
};
/// Throws InputError for follower loads, torques and functions of time, naming what to leave out.
std::vector<PlacedLoad> placed_loads(const PoseForm& form);
/// Sum of their sizes, N.
double total_size(const std::vector<PlacedLoad>& loads);

/// Free-body statics of a scene in so many random poses in which its loops close, in the assembly of the start.
PosesChecked check_in_poses(const Scene& scene, int poses, double weight);

}  // namespace poise
