#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace poise::solvers {

/// v(0), v'(0), v(h), v'(h) as a cubic in tau = sigma / h.
struct Cubic {
  Cubic(double v0, double d0, double v1, double d1, double h)
      : a{v0, h * d0, 3 * (v1 - v0) - 2 * h * d0 - h * d1, -2 * (v1 - v0) + h * d0 + h * d1} {}

  double at(double tau) const { return a[0] + tau * (a[1] + tau * (a[2] + tau * a[3])); }
  double slope(double tau) const { return a[1] + tau * (2 * a[2] + tau * 3 * a[3]); }

  // Least value of p + q tau + r tau^2 (+ s tau^3) on [0, 1].
  static double least_quadratic(double p, double q, double r) {
    double least = std::min(p, p + q + r);
    if (r > 0 && q < 0 && -q < 2 * r) least = std::min(least, p - q * q / (4 * r));
    return least;
  }
  double least() const {
    double value = std::min(a[0], at(1.0));
    // roots of the slope
    const double A = 3 * a[3], B = 2 * a[2], C = a[1];
    const double disc = B * B - 4 * A * C;
    if (disc < 0) return value;
    const double q = -0.5 * (B + std::copysign(std::sqrt(disc), B));
    for (const double tau : {A != 0 ? q / A : -1.0, q != 0 ? C / q : -1.0}) {
      if (tau > 0 && tau < 1) value = std::min(value, at(tau));
    }
    return value;
  }
  // Least value of (v(tau) - v(0)) / tau.
  double least_rise() const { return least_quadratic(a[1], a[2], a[3]); }
  // Largest slope.
  double largest_slope() const { return -least_quadratic(-a[1], -2 * a[2], -3 * a[3]); }

  std::array<double, 4> a;
};

}  // namespace poise::solvers
