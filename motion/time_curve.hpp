#pragma once

#include <vector>

#include "solvers/quintic_spline.hpp"

namespace poise {

/// A function of time, s, made of polynomials: from breaks[i] to breaks[i + 1] it is
///   sum_k coefficient[i][k] (t - breaks[i])^k.
/// Before the first break and after the last it goes on with the nearest polynomial.
class TimeCurve {
 public:
  /// Straight lines between points: two at least, times ascending.
  static TimeCurve through(std::vector<double> time, const std::vector<double>& value);
  static TimeCurve along(const solvers::QuinticSpline& spline);
  /// The coefficients of each interval of `breaks` in turn, the same number for each.
  TimeCurve(std::vector<double> breaks, std::vector<double> coefficients);

  /// The value (derivative = 0), or its first or second derivative by time.
  double at(double t, int derivative = 0) const;
  /// Where the polynomials meet, both ends included.
  const std::vector<double>& breaks() const { return breaks_; }

 private:
  std::vector<double> breaks_, coefficients_;
  std::size_t order_;  // coefficients of one piece
};

}  // namespace poise
