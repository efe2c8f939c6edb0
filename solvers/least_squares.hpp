#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Equilibrium as a least-squares problem for Ceres (Levenberg-Marquardt, exact Jacobian):
///
///   min  |F(x) + J^T y|^2 + |3 c(x)|^2   over (x, y).
///
/// Gaps weigh more than forces: fewer searches then end in an open loop. An inequality becomes a complementarity
/// condition by the residual of Fischer and Burmeister, p(a, b) = a + b - sqrt(a^2 + b^2); where it has two bounds
/// (Billups 1995), p(g - lower, -p(upper - g, y)), zero where y is negative at the lower, positive at the upper bound,
/// else 0. Finds any stationary point; works for fields without a potential. A local minimum of the sum that is not
/// zero is no equilibrium and is not claimed as one. Converged when every residual is below the tolerance (forces
/// relative to 1 + max |F|, gaps without their weight). `rows` lists the constraint rows to keep, all of them when
/// empty.
SearchResult solve_with_least_squares(const Problem& problem, const std::vector<double>& start,
                                      const SearchOptions& options = {}, const std::vector<int>& rows = {});

}  // namespace poise::solvers
