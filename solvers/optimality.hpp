#pragma once

#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// Residual of the optimality conditions at a point, with the multipliers that make it least.
struct Optimality {
  double error = 0.0;               ///< the larger of force_error() and the largest gap or violation of a kept row
  std::vector<double> multipliers;  ///< one per constraint row, zero for inactive rows
};

/// At an evaluated point. Inequalities within `near` of a bound are active unless their multiplier has the wrong sign.
/// `kept` lists the rows that count, all of them when empty.
Optimality optimality_at(const Problem& problem, const Evaluation& at, const std::vector<int>& kept,
                         double near = 1e-7);

}  // namespace poise::solvers
