#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace poise::solvers {

struct FilterOptions {
  double margin = 0.01;         ///< share of gap or force by which a point must improve on those remembered
  double closed_within = 1e-9;  ///< gaps below it count as equal to it
  std::size_t size = 80;        ///< points remembered; beyond, the oldest is forgotten
};

/// Acceptance of steps by a filter (Fletcher, Leyffer 2002). Full Newton steps may increase constraint violation for a
/// while, and no fixed weight of gaps against forces in a merit function suits both ten variables and a hundred
/// thousand. So a point (gap, force), the norms of the residuals of c = 0 and F + J^T y = 0, is accepted when for every
/// remembered point (g, f)
///
///   gap <= (1 - margin) g   or   force <= (1 - margin) f.
class Filter {
 public:
  explicit Filter(const FilterOptions& options = {}) : options_(options) { left_.reserve(options.size); }

  void clear() { left_.clear(); }

  /// Adds a point to the filter. Allocates nothing.
  void remember(double gap, double force) {
    if (left_.size() == options_.size) left_.erase(left_.begin());
    const double part = 1.0 - options_.margin;
    left_.push_back({part * std::max(gap, options_.closed_within), part * force});
  }

  /// Whether the filter accepts a point. False also if either number is not finite.
  bool takes(double gap, double force) const {
    if (!std::isfinite(gap) || !std::isfinite(force)) return false;
    const double counted = std::max(gap, options_.closed_within);
    return std::all_of(left_.begin(), left_.end(),
                       [&](const Point& left) { return counted <= left.gap || force <= left.force; });
  }

 private:
  struct Point {
    double gap, force;
  };

  FilterOptions options_;
  std::vector<Point> left_;
};

}  // namespace poise::solvers
