#pragma once

#include <vector>

#include "design/goals/design_search.hpp"

namespace poise {

/// By how much tolerances move the quantity of each goal at each of its positions, SI, at a choice of numbers: in the
/// worst corner  sum |dQ/dp| half_width,  or what the quantity really differs by in the corners that are worst to first
/// order; else three standard deviations to first order,  3 sqrt(sum (dQ/dp sigma)^2).  Empty where there are no
/// derivatives.
GoalEvaluation::Tightening tightening(const GoalProblem& problem, const DesignPoint& point,
                                      const std::vector<double>& corrections);

/// Limits at samples of the tolerances, and in the corner that is worst for each limit to first order; and the half
/// widths that keep all limits to first order at the least sum of  (given half width) / (half width).
/// `corrections` as of GoalEvaluation::correct().
RobustCheck verify_tolerances(const GoalProblem& problem, const DesignPoint& point,
                              const std::vector<double>& corrections, const GoalSearchOptions& options);

}  // namespace poise
