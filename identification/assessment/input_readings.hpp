#pragma once

#include <vector>

#include "identification/assessment/known_numbers.hpp"

namespace poise {

/// What the estimates would change by if the readings of a load of measured runs were joined by a smooth curve, the
/// spline of degree 5 through them, in place of straight lines: how much the load between its readings, of which
/// nothing is known, may matter. To first order  -V sum_r A_r^T (e_r of the smooth curve - e_r of the lines),  V and A
/// as of StandardErrors; where the load is smooth, that is nearly the error that the lines cause. One effect for each
/// load that has at least 6 readings in a run (fewer are taken for the corners of a line), in all runs together. For a
/// drive, whose curve is smooth, there is none.
/// Throws std::runtime_error where a motion fails at the fit.
std::vector<KnownEffect> input_effects(const FitProblem& problem, const Fit& fitted,
                                       const std::vector<Record>& records);

}  // namespace poise
