#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace poise::solvers {

struct FilterOptions {
  double margin = 0.01;         ///< share of gap or force by which a point must be better than those left behind
  double closed_within = 1e-9;  ///< gaps below it count as none
  std::size_t size = 80;        ///< points remembered; beyond, the oldest is forgotten
};

/// Which points a search may step to (Fletcher, Leyffer 2002). Full Newton steps may open constraints for a while, and
/// no fixed weight of gaps against forces suits both ten variables and a hundred thousand. So a point (gap, force), two
/// norms of what c = 0 and F + J^T y = 0 lack, is taken when against every point (g, f) left behind
///
///   gap <= (1 - margin) g   or   force <= (1 - margin) f.
class Filter {
 public:
  explicit Filter(const FilterOptions& options = {}) : options_(options) { left_.reserve(options.size); }

  void clear() { left_.clear(); }

  /// Leaves a point behind. Allocates nothing.
  void remember(double gap, double force) {
    if (left_.size() == options_.size) left_.erase(left_.begin());
    const double part = 1.0 - options_.margin;
    left_.push_back({part * std::max(gap, options_.closed_within), part * force});
  }

  /// False too where either number is not finite.
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
