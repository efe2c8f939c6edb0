#pragma once

#include <atomic>
#include <optional>
#include <string>
#include <vector>

#include "design/balance/balance_problem.hpp"

namespace poise {

/// What a body has to carry: the first moment m c that is added about a point of it, in its frame.
struct AddedWeight {
  int body = -1;
  Vec2 about{};  ///< that point, in the body's frame, m: its pin to the ground, or its origin where a mass is given
  std::string point;    ///< its name; empty of an origin
  Vec2 first_moment{};  ///< kg m
  double mass = 0.0;    ///< kg
  Vec2 place{};         ///< of the mass, in the body's frame, m
};

/// A phasor in the total first moment: of a body's angle, or of a travel.
struct MomentTerm {
  std::string name;
  Vec2 before{}, after{};  ///< coefficients, kg m; kg of a travel
  bool stays = false;      ///< no choice of the counterweights cancels it together with the others
};

/// The largest size of the force of all links on the frame, N, and of its moment about the world's origin, N m, that
/// their inertia causes while the drive moves evenly.
struct Shaking {
  double force = 0.0, moment = 0.0;
  double at_force = 0.0, at_moment = 0.0;  ///< values of the drive there, rad or m
};

/// Counterweights that cancel the shaking force.
///
/// The force that the inertia of all bodies causes is minus the second derivative by time of their total first moment
/// sum m p, a sum of phasors whose coefficients are linear in the first moments that counterweights add. Closures of
/// loops express phasors by others (method of linearly independent vectors: R. S. Berkof, G. G. Lowen, "A new method
/// for completely force balancing simple linkages", J. Eng. Ind. 91, 1969); where the coefficients of the others vanish
/// the total centre of mass stays in its place, and the force is zero in every motion. Of several solutions the one of
/// least sum of squares of the first moments is taken.
///
/// Where they cannot vanish and a drive is given, the counterweights for which the largest shaking force over its range
/// is least, by a linear program of cuts  e . F(pose) <= t  to which the worst poses are added (a force is as large as
/// its largest component); poses between samples by interpolation of sixth order.
struct ShakingBalance {
  bool balanced = false;
  Scene scene;                       ///< with the counterweights in the bodies
  std::vector<AddedWeight> weights;  ///< as the problem's
  std::vector<MomentTerm> terms;     ///< those that closures leave
  double residual = 0.0;             ///< largest coefficient that cannot be cancelled, over the largest of a body
  bool complete = true;              ///< the terms are found to be independent, so that none else cancels them
  int closures = 0;
  double moved = 0.0, moved_before = 0.0;  ///< largest shift of the total first moment in random poses, kg m
  std::optional<Shaking> before, after;    ///< where a drive is given
  bool is_least = false;                   ///< the weights make the largest force least
  double lower = 0.0;                      ///< bound of that from below, by the program over finitely many poses, N
  bool whole_range = true;                 ///< it was driven through
  std::string why;                         ///< not
};

/// Throws InputError where a body cannot carry what is asked for, or the drive does not move it.
ShakingBalance balance_shaking(const BalanceProblem& problem, const std::atomic<bool>* interrupt = nullptr);

/// Over the range of the problem's drive. `why`: where it ends before.
Shaking shaking_of(const BalanceProblem& problem, const Scene& scene, std::string& why);

}  // namespace poise
