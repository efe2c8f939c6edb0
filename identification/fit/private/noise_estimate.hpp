#pragma once

// The noise of sensors, where it is not stated.

#include "identification/fit/private/minimise.hpp"

namespace poise {

/// Says whether the noise of a sensor is estimated: it is where it is not stated, and the scale of Student's t always.
bool estimates_noise(const FitProblem& problem, const Weighting& weighting, std::size_t sensor);

/// A minimum and the noise that its residuals count over.
struct WeightedMinimum {
  Minimum minimum;
  Weighting weighting;
};

/// Finds the noise of sensors and the minimum by turns, since the noise follows from the residuals of the fit, which
/// follows from the noise of all; from a minimum and a first guess of the noise. With the values that the readings of
/// each sensor determine subtracted from their number, the sizes are those of restricted maximum likelihood (D. A.
/// Harville, 1977).
WeightedMinimum estimate_noise(const FitTask& task, WeightedMinimum from, FitEffort& effort);

}  // namespace poise
