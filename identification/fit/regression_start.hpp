#pragma once

#include <optional>
#include <vector>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Parameters that need no guess and no motion: where the sensors tell all freedoms of all runs, smoothing splines give
/// states z, w with accelerations a (RunModel::states_from_readings), and the parameters p minimise
///   sum |alpha(z, w, p) - a|^2,  each freedom over the root mean square of its a,
/// by Gauss and Newton's method within their ranges from the experiment's starts. Numbers of sensors keep their starts.
/// Errors of a, which are those of the readings over squares of times, bias them: they are good for a start alone.
/// Empty where the experiment is not of this kind, or no parameter moves anything.
std::optional<std::vector<double>> start_from_regression(const FitProblem& problem, const std::vector<Record>& records);

}  // namespace poise
