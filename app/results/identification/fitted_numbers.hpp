#pragma once

#include <string>

#include "app/result/result.hpp"
#include "identification/assessment/identify.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise::app {

/// What predictions need of a fit, as data: all unknowns with their values also where they are withheld, the covariance
/// of their errors, and the directions that the readings leave open. None where the fit has no standard errors.
void add_fitted_numbers(Group& content, const FitProblem& problem, const Identification& answer);

/// Reads it from what `poise identify --json FILE` wrote, for a scene, whose numbers keep their values. Left out are
/// numbers of sensors, numbers that differ from run to run, and those which the fit took as known where the scene has
/// other values. Throws InputError where the file is no such result, the fit did not converge, or the scene lacks a
/// number.
FittedNumbers read_fitted_numbers(const std::string& file, const Scene& scene);

}  // namespace poise::app
