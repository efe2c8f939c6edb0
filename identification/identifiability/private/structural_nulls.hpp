#pragma once

#include <vector>

#include "identification/identifiability/null_space.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Directions of the parameters that change no motion of the mechanism and no reading in any run, at the given values:
/// those v with
///   sum_p d alpha/dp v_p = 0,   sum_p d(reading)/dp v_p = 0   at fixed z, w
/// in all states (z, w) of every run, each with its own scene, and v_p = 0 where p has a prior. In a run whose start is
/// estimated, and on whose motion time does not act, the second sum may be any part c of d(reading)/dt, the same of all
/// sensors: the start makes up for a delay of all. They follow from the
/// equations of motion to rounding, whatever the runs do. Where a run has no motion its rows are missing. There are
/// none of a scene with controllers, which also decide at instants that no state tells.
NullSpace structural_nulls(const FitProblem& problem, const std::vector<double>& parameters,
                           const std::vector<std::vector<double>>& nuisances);

}  // namespace poise
