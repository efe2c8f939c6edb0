#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace poise {

/// The median size of x over that of normal noise of unit standard deviation, 0.6745; then the same of the values below
/// 6 times the last result, until it stays: an estimate of the standard deviation that a minority of outliers does not
/// change. 0 for no values.
inline double robust_scale(std::vector<double> x) {
  constexpr double normal_median = 0.674489750196082;
  constexpr double outlying = 6.0;
  for (double& value : x) value = std::abs(value);
  std::sort(x.begin(), x.end());
  double scale = 0.0;
  for (std::size_t count = x.size(); count > 0;) {
    scale = x[count / 2] / normal_median;
    const auto inside = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), outlying * scale) - x.begin());
    if (inside >= count) break;
    count = inside;
  }
  return scale;
}

}  // namespace poise
