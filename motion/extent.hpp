#pragma once

#include <algorithm>
#include <limits>

namespace poise {

/// Least and greatest of the values added.
struct Extent {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  void add(double v) {
    min = std::min(min, v);
    max = std::max(max, v);
  }
  double width() const { return max - min; }
};

}  // namespace poise
