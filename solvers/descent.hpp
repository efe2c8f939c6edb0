#pragma once

#include <vector>

#include "solvers/loop_closing.hpp"
#include "solvers/newton_system.hpp"

namespace poise::solvers {

/// Descends the objective on the constraints to a local minimum. Every step keeps them closed: the tangent is shifted
/// until it is positive definite on the null space of J, and the step halved until the Lagrangian L = f + y^T c
/// decreases,
///
///   L(x + alpha d) <= L(x) + armijo alpha L'(x) d,
///
/// at a saddle or maximum along a direction of negative curvature. L decreases with every step, so the run ends at a
/// minimum, diverges, or is stopped by a limit.
class Descent {
 public:
  Descent(NewtonSystem& system, LoopClosing& closing);

  /// Closes the constraints first; poses where J loses rank are perturbed.
  NewtonEnd run();
  /// Starts from a point where the constraints hold.
  NewtonEnd run_from_closed();

 private:
  NewtonEnd descend();
  void shift_until_positive_definite();
  bool leave_saddle();
  bool step(double alpha);
  bool perturb();
  bool ran_away() const;

  NewtonSystem& at_;
  LoopClosing& closing_;
  double shift_ = 0.0;  // the last that made the tangent positive definite
  std::vector<double> direction_, perturbed_;
};

}  // namespace poise::solvers
