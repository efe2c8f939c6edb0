#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Which tangent an augmented Lagrangian method uses.
enum class Tangent {
  newton,   ///< K = dF/dx + sum (k lambda + p c)_r d2 c_r + p J^T J
  modified  ///< without the second derivatives of the constraints, as in MECANO
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
/// k and p do not change the direction in x: p J^T J d = -p J^T c on J d = -c, and k only scales lambda. They determine
/// the multipliers y = k lambda + p c, and with them the curvature of c in the tangent, at points with c != 0. Steps
/// are at most 3 (rad, mechanism sizes) and halved until a filter accepts the point: compared with every point left
/// behind, |c| or |F + J^T y| must be smaller. If none is accepted, the full step is taken, up to 20 times in a run,
/// and the filter is cleared. The modified tangent converges linearly, and only where, along the constraints,
/// (dF/dx)^-1 times the true tangent has eigenvalues that halved steps can bring within the unit circle: never to an
/// equilibrium that is stable by the curvature of the constraints alone, as in a hanging chain.
///
/// Inequalities are handled by an active set: violated ones are added to the equations, ones whose multiplier has the
/// wrong sign are removed. Converged when max |c| <= tolerance and max |F + J^T y| <= tolerance (1 + max |F|), unless
/// multipliers exceed 1e6 of that scale (a singular configuration) or rows left out do not hold. `rows` lists the
/// constraint rows to keep, all of them when empty. Multipliers returned are y. Source: SAMTECH, MECANO Motion Theory,
/// 2000.
SearchResult solve_with_augmented_lagrangian(const Problem& problem, const std::vector<double>& start,
                                             const AugmentedLagrangianOptions& options = {},
                                             const std::vector<int>& rows = {});

}  // namespace poise::solvers
