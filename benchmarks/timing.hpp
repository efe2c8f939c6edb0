#pragma once

#include <functional>
#include <string>
#include <vector>

namespace poise::benchmarks {

/// Seconds per call, on average of that many.
double seconds_of(const std::function<void()>& work, int times);

/// Of at least one value; the upper one of the middle two.
double median(std::vector<double> values);

/// "1.23 us", "12.3 us", "1.23 ms".
std::string in_units(double seconds);

}  // namespace poise::benchmarks
