#pragma once

#include <vector>

#include "motion/simulate.hpp"

namespace poise {

/// Largest |T + V - work - (T + V at start)| of a motion's nodes over the largest energy exchanged.
double energy_error(const Motion& motion);

/// Times at which a smooth function that is known by its absolute value, `size` at the times t, passes zero: between
/// samples i - 1 and i where size falls and rises again, and where two samples before and two behind make a
/// straighter line with the latter negative. A sample next to the zero makes two intervals look so: the straighter one
/// has it.
std::vector<double> zero_crossings(const std::vector<double>& t, const std::vector<double>& size);

}  // namespace poise
