#pragma once

// Fits of runs whose inputs have noise.

#include "identification/fit/private/noise_estimate.hpp"

namespace poise {

/// Takes what the noise of inputs does to readings, Weighting::inputs, as it is at the minimum, which moves then, by
/// turns. With the covariance S of the residuals e over their noise and their derivatives A, which contain the noise w
/// of the inputs as e does,
///   E[A^T S^-1 e] = 1/2 d log det S/d parameters = g,
/// so that residuals count less an offset d with A^T d = g (nuisances eliminated; W A V g in terms of whitened rows):
/// it makes A^T (e - d) zero on average at the truth, as the maximum of the likelihood over the inputs themselves does.
///
/// Where the noise of inputs is overstated that is too much, and all is done with less: the factor c of the noise that
/// makes  log det S + e^T S^-1 e  least, Weighting::input_noise, where this is lower by more than chance makes it once
/// in 10^4 fits. A larger factor would explain what a model lacks, and is only told.
///
/// The noise of sensors that another fit gives stays. Source: T. Soderstrom, Errors-in-variables methods in system
/// identification, 2018, for the bias.
WeightedMinimum weigh_by_input_errors(const FitTask& task, WeightedMinimum from, FitEffort& effort);

}  // namespace poise
