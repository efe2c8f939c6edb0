#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Integrates the damped motion of fictitious masses under the field until equilibrium (dynamic relaxation):
///
///   M x'' = -(F + J^T y),   J M^-1 (F + J^T y) = 0,   c(x) = 0
///
/// by explicit unit time steps. The masses M keep them stable: at each step at least 0.3 of the tangent's row sum
/// (Gershgorin; 1/4 is the limit) and 0.5 of the forces |F| + |J^T| |y|, for loads whose stiffness passes zero. Rates
/// and positions are projected on the constraints in the metric M. Kinetic damping: when the power of the forces
/// becomes negative the kinetic energy has passed its peak; x goes back to the peak, the rates are set to zero and the
/// masses are chosen anew. First order: the tangent is used for the masses alone. Works for fields without a potential.
///
/// Inequalities are handled by an active set. Converged when max |c| <= tolerance and max |F + J^T y| <= tolerance (1 +
/// max |F|), unless multipliers exceed 1e6 of that scale (a singular configuration) or rows left out do not hold.
/// Iterations are time steps. `rows` lists the constraint rows to keep, all of them when empty. Source: A. S. Day, An
/// introduction to dynamic relaxation, The Engineer 219 (1965); kinetic damping: P. Cundall, 1976.
SearchResult solve_with_dynamic_relaxation(const Problem& problem, const std::vector<double>& start,
                                           const SearchOptions& options = {.iterations = 20000},
                                           const std::vector<int>& rows = {});

}  // namespace poise::solvers
