#pragma once

#include <Eigen/Core>

namespace poise {

/// Linear equations within linear bounds:  a x = b,  g x <= h.
struct BoundedSystem {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
  Eigen::MatrixXd g;
  Eigen::VectorXd h;
  Eigen::VectorXd cost;  ///< of the solutions one with least cost x; where it is zero the one nearest to `near`, if
                         ///< within the bounds
  Eigen::VectorXd near;
  double size = 0.0;  ///< of what the right side is a sum of, which may cancel: less than 1e-9 of it is rounding
};

/// Its answer, or why there is none: multipliers y and mu >= 0 with  a' y = g' mu  and  mu h < y b, which no x allows,
/// since  y b = y a x = mu g x <= mu h  (Farkas).
struct BoundedSolution {
  bool solved = false;
  Eigen::VectorXd x;
  double residual = 0.0;  ///< largest |a x - b| over the size of the right side
  Eigen::VectorXd y, mu;
  double demand = 0.0, most = 0.0;  ///< y b and mu h
  int row = -1;                     ///< the only one that y has, where one equation alone cannot be met
};

/// Solves the equations by singular values, and what they leave open by a linear program. Equations that repeat others
/// to rounding (1e-11) do not matter. Where there is no solution an equation that cannot be met by itself is looked for
/// first: that which misses by most.
BoundedSolution solve(const BoundedSystem& system);

/// Whether the multipliers prove that there is no solution with unknowns of at most the sizes `largest`, which the
/// bounds imply: mu >= 0, and y b exceeds mu h by more than what rounding leaves open in a' y = g' mu for such
/// unknowns.
bool is_refutation(const BoundedSystem& system, const BoundedSolution& solution, const Eigen::VectorXd& largest);

}  // namespace poise
