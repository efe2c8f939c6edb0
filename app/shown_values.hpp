#pragma once

// Values as they are shown, without what is rounding in them.

#include <vector>

#include "app/quantity.hpp"
#include "statics/scaled_model.hpp"

namespace poise::app {

/// Size below which a value of this mechanism is rounding and is shown as zero, SI: 1e-13 of the scale of its lengths,
/// forces or work.
double rounding_of(const ScaledModel& model, Quantity quantity);

/// SI values in the scene's unit, rounding put to zero.
std::vector<double> in_units(const ScaledModel& model, Quantity quantity, std::vector<double> values);

}  // namespace poise::app
