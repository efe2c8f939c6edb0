#pragma once

#include <string>
#include <vector>

namespace poise::app {

struct Tick {
  double at = 0.0;
  std::string label;
};

/// The part of a line that a chart shows, and where it is marked.
struct Axis {
  double low = 0.0, high = 1.0;
  std::vector<Tick> ticks;

  bool contains(double value) const { return low <= value && value <= high; }
};

/// An axis for all finite values, `margin` times their span wider at both ends, with marks at multiples of 1, 2 or 5
/// powers of ten, about `marks` of them. What varies by less than 1e-10 of its size is shown as constant.
Axis linear_axis(const std::vector<double>& values, double margin, int marks);

/// An axis of whole decades round all positive finite values, at most about `marks` of them marked.
Axis log_axis(const std::vector<double>& values, int marks);

}  // namespace poise::app
