#pragma once

#include <vector>

#include "statics/model/scaled_model.hpp"

namespace poise {

/// How far the closures may be off because the numbers of a scene were rounded to doubles: per closure of the layout
/// the sum of a unit in the last place of every number of its loop, half of it for the number as written and half for
/// its conversion to SI, in scaled units. A constant angle counts with its arm, a direction with a travel of one unit.
///
/// To about that, the rows of a closure and their derivatives are determined by the scene as written. A rank that
/// depends on less is not.
std::vector<double> closure_rounding(const ScaledModel& model);

/// The same per constraint row of the mechanism: for rows of closures their closure's, for stops a unit in the
/// last place.
std::vector<double> row_rounding(const ScaledModel& model);

}  // namespace poise
