#pragma once

#include <optional>
#include <vector>

#include "identification/assessment/identify.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise {

/// Of FittedNumbers::notes, where the residuals are larger than the noise.
inline constexpr const char* misfit_note = "The fit has a misfit: intervals do not contain what its model lacks.";

/// What predictions need of a fit: all unknowns with their values also where they are withheld, the covariance of their
/// errors with those of known numbers, and the directions that the readings leave open: nulls, and numbers that are
/// withheld for other reasons. Errors of curved estimates are those of their profiles. Empty where the fit has no
/// standard errors.
std::optional<FittedNumbers> carried_numbers(const FitProblem& problem, const Identification& answer);

/// The nulls of an assessment at these values as directions of the parameters, SI.
std::vector<FittedNumbers::Direction> nulls_of(const FitProblem& problem, const std::vector<double>& parameters,
                                               const Identifiability& found);

}  // namespace poise
