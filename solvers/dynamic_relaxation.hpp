#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

/// Lets the problem move under its field, damped, until it rests (dynamic relaxation): x'' = -(F + J^T y) with
/// fictitious masses, constraints kept by projection of rates and places, explicit steps, and kinetic damping (rates
/// are set to zero where the kinetic energy passes a peak). First order: it needs no tangent but for the masses. Works
/// for fields without a potential. Inequalities are held by an active set. Converged when max |c| <= tolerance and max
/// |F + J^T y| <= tolerance (1 + max |F|). Iterations are time steps. `rows` lists the constraint rows to keep, all of
/// them when empty. Source: A. S. Day, An introduction to dynamic relaxation, The Engineer 219 (1965); kinetic damping:
/// P. Cundall, 1976.
SearchResult solve_with_dynamic_relaxation(const Problem& problem, const std::vector<double>& start,
                                           const SearchOptions& options = {.tolerance = 1e-10, .iterations = 20000},
                                           const std::vector<int>& rows = {});

}  // namespace poise::solvers
