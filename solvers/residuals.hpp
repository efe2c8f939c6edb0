#pragma once

#include <vector>

#include "solvers/active_set.hpp"
#include "solvers/problem.hpp"

namespace poise::solvers {

/// out = F + J^T y, with one multiplier for each constraint row.
void unbalanced(const Problem& problem, const Evaluation& at, const std::vector<double>& y, std::vector<double>& out);

/// max |F + J^T y| / (1 + max |F|): the quantity that the programs compare with their tolerance.
double force_error(const Problem& problem, const Evaluation& at, const std::vector<double>& y);

/// The y with minimal |F + J^T y|, and of those the one of minimum norm, zero for rows not in `rows`. One per
/// constraint row.
std::vector<double> least_squares_multipliers(const Problem& problem, const Evaluation& at,
                                              const std::vector<int>& rows);

/// Why a point at which all tolerances are met is still no solution, as a clause of a message; null if it is one.
/// Multipliers beyond a million times the field mean that J loses rank there. Rows left out as redundant at the start
/// need not be redundant here; they must hold to 1e-9, or the tolerance if that is larger.
const char* objection(const Evaluation& at, const ActiveSet& active, const std::vector<double>& y, double tolerance);

}  // namespace poise::solvers
