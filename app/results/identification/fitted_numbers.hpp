#pragma once

#include <string>

#include "app/result/result.hpp"
#include "identification/assessment/identify.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise::app {

/// What predictions need of a fit, carried_numbers(), as data; null where there are none.
void add_fitted_numbers(Group& content, const FitProblem& problem, const Identification& answer);

/// Masses, first moments and inertias that the readings determine where they leave what these are made of open.
void add_determined_inertia(Group& content, const FitProblem& problem, const Identification& answer);

/// Reads it from what `poise identify --json FILE` wrote: the numbers that a scene has, as FittedNumbers::of(). Throws
/// InputError where that does, where the file is no such result, and where the fit did not converge.
FittedNumbers read_fitted_numbers(const std::string& file, const Scene& scene);

}  // namespace poise::app
