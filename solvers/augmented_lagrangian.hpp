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
/// in the unknowns (x, lambda), from least-squares multipliers. Works for fields without a potential.
///
/// k and p do not change the direction in x: p J^T J d = -p J^T c on J d = -c, and k only scales lambda. They decide
/// which multipliers y = k lambda + p c, and so which curvature of c, a point has that is not closed yet. Steps are at
/// most 3 (rad, mechanism sizes) and halved until a filter takes the point: against every one left behind |c| or
/// |F + J^T y| must be smaller. Where none is taken, up to 20 times in a run, the whole step is, and the filter starts
/// afresh. The modified tangent converges linearly, and only where, along the constraints, (dF/dx)^-1 times the true
/// tangent has eigenvalues that the halved steps can bring within the unit circle: never to a rest that the curvature
/// of the constraints alone makes stable, as in a hanging chain.
///
/// Inequalities are held by an active set: violated ones join the equations, ones that pull leave them.
/// Converged when max |c| <= tolerance and max |F + J^T y| <= tolerance (1 + max |F|), unless multipliers exceed 1e6 of
/// that scale (a singular configuration) or rows left out do not hold. `rows` lists the constraint rows to keep, all of
/// them when empty. Multipliers returned are y. Source: SAMTECH, MECANO Motion Theory, 2000.
SearchResult solve_with_augmented_lagrangian(const Problem& problem, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions& options = {},
                                             const std::vector<int>& rows = {});

}  // namespace poise::solvers
