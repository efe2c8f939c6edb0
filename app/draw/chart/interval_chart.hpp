#pragma once

#include <string>
#include <vector>

#include "app/draw/chart/plot.hpp"

namespace poise::app {

/// A value with the interval round it.
struct Interval {
  std::string name;
  double low = 0.0, value = 0.0, high = 0.0;
};

/// The intervals side by side over their numbers, from 1, with which the legend names them. What is not finite is left
/// out and keeps its number.
std::vector<Curve> interval_curves(const std::vector<Interval>& intervals);

}  // namespace poise::app
