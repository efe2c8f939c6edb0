#pragma once

#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// What is missing at a point for it to be stationary, with the multipliers that leave least.
struct Optimality {
  double error = 0.0;               ///< the larger of force_error() and the largest gap or overrun of a kept row
  std::vector<double> multipliers;  ///< one per constraint row, zero for rows that do not hold
};

/// Of an evaluated point. Inequalities within `near` of a bound hold unless they would pull. `kept` lists the rows that
/// count, all of them when empty.
Optimality optimality_at(const Problem& problem, const Evaluation& at, const std::vector<int>& kept,
                         double near = 1e-7);

}  // namespace poise::solvers
