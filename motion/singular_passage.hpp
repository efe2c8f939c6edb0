#pragma once

#include <vector>

namespace poise {

/// Zero crossings of a smooth function given by its absolute value, `size` at the times t: between samples i - 1 and i
/// where size decreases and increases again, and where two samples before and two after lie on a straighter line with
/// the latter negated. If a sample next to the zero makes two intervals qualify, the straighter one is taken.
std::vector<double> zero_crossings(const std::vector<double>& t, const std::vector<double>& size);

/// A step of about h from the last of the nodes t that avoids evaluation at a singular pose ahead, where the pivots
/// tend to zero: the pose lies midway between two stages of RungeKutta78, or well beyond the end.
double steered_step(const std::vector<double>& t, const std::vector<double>& pivot, double h);

}  // namespace poise
