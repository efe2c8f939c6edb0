#pragma once

#include "solvers/search.hpp"

namespace poise::solvers {

enum class NloptAlgorithm {
  slsqp,         ///< sequential quadratic programming (Kraft), exact gradients
  auglag_lbfgs,  ///< augmented Lagrangian (Birgin, Martinez) around L-BFGS, exact gradients
  cobyla         ///< linear approximations (Powell), no derivatives
};

/// min f(x) subject to the problem's constraints, by NLopt. The problem must have an objective. NLopt gives no
/// multipliers: those returned are recovered from F + J^T y = 0 by least squares over the rows that hold.
///
/// The tolerance is that on steps (relative and absolute) and on constraints. As long as it reduces the error in F +
/// J^T y and in the constraints, slsqp and auglag_lbfgs are started again from their last point, each time rescaled to
/// the remaining error (solvers/rescaled_problem.hpp). Success is as NLopt reports it. Iterations are evaluations.
///
/// cobyla compares values of f only, and rounding of f hides steps below 1e-8.
///
/// `rows` lists the constraint rows to keep, all of them when empty.
SearchResult solve_with_nlopt(NloptAlgorithm algorithm, const Problem& problem, const std::vector<double>& start,
                              const SearchOptions& options = {}, const std::vector<int>& rows = {});

}  // namespace poise::solvers
