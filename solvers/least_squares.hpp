#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Equilibrium as a least-squares problem for Ceres (Levenberg-Marquardt, exact Jacobian):
///
///   min  |F(x) + J^T y|^2 + |c(x)|^2   over (x, y),
///
/// stops as complementarity by the residual of Fischer and Burmeister, a + b - sqrt(a^2 + b^2), with a the distance to
/// the bound and b the multiplier. Finds any stationary point; works for fields without a potential. A local minimum
/// of the sum that is not zero is no equilibrium. Converged when every residual is below the tolerance (forces relative
/// to 1 + max |F|). `rows` lists the constraint rows to keep, all of them when empty.
SearchResult solve_with_least_squares(const Problem& problem, const std::vector<double>& start,
                                      const SearchOptions& options = {}, const std::vector<int>& rows = {});

}  // namespace poise::solvers
