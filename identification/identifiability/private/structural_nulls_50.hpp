#pragma once

#include <optional>
#include <vector>

#include "identification/identifiability/null_space.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// structural_nulls() from the same states in 50 digits, for what rounding of doubles leaves in doubt.
///
/// With columns of length one and Householder's |R_11| >= |R_22| >= ..., the dimension is that of the R_kk that vanish
/// in 50 digits. The others are effects, however small, where a change of the scene's numbers in the last bits of their
/// scales changes them by less than a thousandth; else they may come from rounding of these numbers, as of the cosine
/// of a right angle, and nothing is decided. A number has no part in the null space where its row vanishes in 50
/// digits.
///
/// Empty without a decision, and where a run has unknowns of its geometry or its sensors, an equilibrium, drives or
/// inputs, all of which are computed in doubles only. `actions` are those of each run.
std::optional<NullSpace> structural_nulls_50(const FitProblem& problem, const std::vector<RunModel::Actions>& actions);

}  // namespace poise
