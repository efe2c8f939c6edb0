#pragma once

#include <string>
#include <vector>

#include "identification/experiment/experiment.hpp"

namespace poise {

/// All runs of several experiments as one, for one fit; `file` is the file that names them.
///
/// Unknowns of one name are one number in all of them: they must have the same unit, dimension, `per` and `includes`;
/// the ranges are intersected, and a start or prior that one of them gives is that of all. Known numbers of one path
/// have one error. Sensors of one name are one sensor where they read the same of the same scene with the same noise,
/// otherwise the name of the experiment's file tells them apart, as it does all runs. Throws InputError where the
/// experiments contradict each other.
Experiment join_experiments(std::string file, std::vector<Experiment> parts);

}  // namespace poise
