#pragma once

#include <vector>

namespace poise {

/// Times at which a smooth function that is known by its absolute value, `size` at the times t, passes zero: between
/// samples i - 1 and i where size falls and rises again, and where two samples before and two behind make a
/// straighter line with the latter negative. A sample next to the zero makes two intervals look so: the straighter one
/// has it.
std::vector<double> zero_crossings(const std::vector<double>& t, const std::vector<double>& size);

/// A step of about h from the last of the nodes t that keeps away from a singular pose ahead, where the pivots tend to
/// zero: the pose comes to lie midway between two stages of RungeKutta78, or well behind the end.
double steered_step(const std::vector<double>& t, const std::vector<double>& pivot, double h);

}  // namespace poise
