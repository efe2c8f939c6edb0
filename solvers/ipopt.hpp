#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// min f(x) subject to the problem's constraints, by the interior point method of Ipopt with exact Jacobian and Hessian
/// of the Lagrangian. `rows` lists the constraint rows to keep (all of them when empty): Ipopt does not accept more
/// equalities than variables. The problem must have an objective. The tolerance is Ipopt's `tol`: the scaled optimality
/// error. Iterations are those of the interior point method.
SearchResult solve_with_ipopt(const Problem& problem, const std::vector<double>& start,
                              const SearchOptions& options = {.tolerance = 1e-14}, const std::vector<int>& rows = {});

}  // namespace poise::solvers
