#pragma once

#include <memory>
#include <span>

#include "solvers/damped_problem.hpp"

namespace poise::solvers {

/// The damped motion of a problem with several freedoms. A step of length h in time is extrapolated (P. Deuflhard,
/// "Recent progress in extrapolation methods for ordinary differential equations", SIAM Review 27, 1985) from j = 1, 2,
/// ... linearly implicit Euler steps of length h / j,
///
///   [ K + D j / h   J^T ] [ d ]     [ F ]
///   [ J              0  ] [ y ] = - [ 0 ],   K = dF/dx + sum y_r d2c_r/dx2,
///
/// each closed onto c = 0; it is accepted once two extrapolations agree to the tolerance. Bounds are met, and left
/// where they would pull, at the times when that happens, to which steps are shortened; switches likewise. Where a
/// distance comes near a limit or switch, the way between the ends of the step is searched for a place where it passes.
///
/// Newton's method finishes where K is positive definite on the null space of J, the first correction is short and the
/// second at most a quarter of it: then (Kantorovich) K changes by less than itself on the way, the energy is convex
/// around the equilibrium, and the motion ends there too.
class DampedMotion {
 public:
  /// `problem` must outlive this.
  explicit DampedMotion(const DampedProblem& problem, const DampedOptions& options = {});
  ~DampedMotion();
  DampedMotion(const DampedMotion&) = delete;
  DampedMotion& operator=(const DampedMotion&) = delete;

  /// Moves from a point with c(x) = 0, with another tolerance where `tolerance` is positive.
  const DampedResult& run(std::span<const double> x, double tolerance = 0.0);

 private:
  class Integrator;
  std::unique_ptr<Integrator> integrator_;
};

}  // namespace poise::solvers
