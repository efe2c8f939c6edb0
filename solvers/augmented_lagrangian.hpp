#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Where the tangent of an augmented Lagrangian comes from.
enum class Tangent {
  newton,   ///< K = dF/dx + sum (k lambda + p c)_r d2 c_r + p J^T J
  modified  ///< without the second derivatives of the constraints, as MECANO has it
};

struct AugmentedLagrangianOptions : SearchOptions {
  Tangent tangent = Tangent::newton;
  double multiplier_scale = 1.0;  ///< k, > 0
  double penalty = 10.0;          ///< p, >= 0
};

/// A stationary point of  V + k lambda^T c + p/2 c^T c  (MECANO Motion Theory, eqs. 6-9) by Newton-Raphson on
///
///   F(x) + J^T (k lambda + p c) = 0,   k c = 0
///
/// in the unknowns (x, lambda), with the step halved while both residuals grow. Works for fields without a potential.
/// Inequalities are held by an active set: violated ones join the equations, ones that pull leave them.
/// Converged when max |c| <= tolerance and max |F + J^T y| <= tolerance (1 + max |F|). `rows` lists the constraint
/// rows to keep, all of them when empty. Multipliers returned are y = k lambda + p c.
/// Source: SAMTECH, MECANO Motion Theory, 2000.
SearchResult solve_with_augmented_lagrangian(const Problem& problem, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions& options = {},
                                             const std::vector<int>& rows = {});

}  // namespace poise::solvers
