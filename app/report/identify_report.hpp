#pragma once

#include <string>

#include "app/fit_files.hpp"
#include "app/palette.hpp"

namespace poise::app {

/// What a fit found, how sure that is, and what cannot be known. No number of a withheld estimate is printed.
std::string identify_report(const FitProblem& problem, const FitAnswer& answer, const Palette& palette);

}  // namespace poise::app
