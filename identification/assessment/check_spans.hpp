#pragma once

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Compares the records of measured runs with the natural frequencies f at the starts of the parameters, about the pose
/// in which a run begins. Throws InputError, which names file, column and remedy, where the time column of a run
/// without `time_factor` must be in another unit than seconds:
///   span f > 1e5 of the slowest mode,
///   span f > 1000 with fewer than two readings per oscillation of the slowest mode,
///   span f < 0.01 of the fastest one.
/// Records of oscillations hold some 5 to 10 000 of them, and a start that is wrong by a factor of 10 in stiffness
/// moves f by 3. Where nothing restores the pose, its frequencies are those with springs that act in both directions. A
/// run that states its time_factor is believed. So is one whose pose nothing restores even then.
void check_spans(const FitProblem& problem);

}  // namespace poise
