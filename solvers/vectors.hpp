#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace poise::solvers {

/// max |v_i|; 0 for none. Infinite if any entry is NaN, so that no tolerance is met then.
inline double largest(std::span<const double> v) {
  double worst = 0.0;
  for (const double e : v) {
    const double size = std::abs(e);
    if (!(size <= worst)) worst = std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
  }
  return worst;
}

/// max |a_i - b_i| over the length of a; b is at least as long.
inline double largest_difference(std::span<const double> a, std::span<const double> b) {
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// sum a_i b_i over the length of a; b is at least as long.
inline double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace poise::solvers
