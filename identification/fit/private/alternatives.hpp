#pragma once

// Minima that explain the readings equally well.

#include <string>
#include <vector>

#include "identification/fit/private/minimise.hpp"

namespace poise {

/// Minima whose sums of squared residuals, over the noise, differ by less than this are equally good: of two, noise
/// prefers the wrong one by that much with a probability of at most Phi(-sqrt(16)) = 3e-5.
inline constexpr double equally_good = 16.0;

/// Returns by how much the sum of squared residuals over the noise exceeds that of the best minimum.
double more_than_best(const FitTask& task, double cost, double best_cost);

/// Describes a minimum with these parameters as a Fit does. `frequencies` are those about it.
Alternative alternative_at(const FitProblem& problem, const std::vector<double>& parameters,
                           const Frequencies& frequencies, double more);

/// Selects the minima that are as good as the best one and have other frequencies than each other, the best first.
/// There are none where only one is so.
std::vector<Alternative> alternatives_among(const FitTask& task, std::vector<Minimum> minima, double best_cost);

/// Says "2 minima explain the readings equally well, with frequencies of 4.6 Hz and 5.4 Hz; read faster ..."
std::string ambiguity_in_words(const std::vector<Alternative>& alternatives);

}  // namespace poise
