#pragma once

#include <vector>

#include "solvers/active_set.hpp"
#include "solvers/problem.hpp"

namespace poise::solvers {

/// out = F + J^T y, with one multiplier for each constraint row.
void unbalanced(const Problem& problem, const Evaluation& at, const std::vector<double>& y, std::vector<double>& out);

/// max |F + J^T y| / (1 + max |F|): what the programs compare with their tolerance.
double force_error(const Problem& problem, const Evaluation& at, const std::vector<double>& y);

/// The y with minimal |F + J^T y|, and of those the shortest, zero for rows not in `rows`. One per constraint row.
std::vector<double> least_squares_multipliers(const Problem& problem, const Evaluation& at,
                                              const std::vector<int>& rows);

/// Why a point at which all tolerances are met is no answer all the same, a clause for a person; null where it is one.
/// Multipliers beyond a million times the field balance nothing: J loses rank there. Rows left out as repeating others
/// at the start need not do so here; they must hold to 1e-9, or the tolerance where that is looser.
const char* objection(const Evaluation& at, const ActiveSet& active, const std::vector<double>& y, double tolerance);

}  // namespace poise::solvers
