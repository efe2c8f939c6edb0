#pragma once

#include <string>

#include "identification/assessment/validation.hpp"

namespace poise::app {

/// Reads what `poise identify --json FILE` wrote. Throws InputError where the file is no such result, or where its fit
/// neither converged nor was interrupted.
FittedModel read_fit(const std::string& file);

/// Reads from such a file what a fit of the same unknowns goes on from (FitOptions::continued): parameters, and
/// nuisances and noise as far as they are there. Throws InputError where the file is no such result, or where it lacks
/// a parameter of the problem.
Fit read_reached(const std::string& file, const FitProblem& problem);

}  // namespace poise::app
