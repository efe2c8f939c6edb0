#pragma once

#include <limits>

namespace poise {

/// The polynomial of degree 5 on 0 <= x <= 1 through values, rates and accelerations at both ends.
struct Quintic {
  double c[6];

  Quintic(double h, double g0, double v0, double a0, double g1, double v1, double a1) {
    v0 *= h;
    v1 *= h;
    a0 *= h * h / 2;
    a1 *= h * h / 2;
    const double far = g1 - g0 - v0 - a0, fast = v1 - v0 - 2 * a0, bends = a1 - a0;
    c[0] = g0;
    c[1] = v0;
    c[2] = a0;
    c[3] = 10 * far - 4 * fast + bends;
    c[4] = -15 * far + 7 * fast - 2 * bends;
    c[5] = 6 * far - 3 * fast + bends;
  }
  double at(double x) const { return c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))); }
  double slope(double x) const { return c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5]))); }
  /// Whether it is positive everywhere: all its coefficients in Bernstein's basis are.
  bool is_positive() const {
    constexpr double choose[6][6] = {{1, 0, 0, 0, 0, 0},       {1, 0.2, 0, 0, 0, 0},       {1, 0.4, 0.1, 0, 0, 0},
                                     {1, 0.6, 0.3, 0.1, 0, 0}, {1, 0.8, 0.6, 0.4, 0.2, 0}, {1, 1, 1, 1, 1, 1}};
    for (const auto& row : choose) {
      double b = 0.0;
      for (int k = 0; k < 6; ++k) b += row[k] * c[k];
      if (!(b > 0.0)) return false;
    }
    return true;
  }
  /// Where the slope, of opposite signs at both ends, or else the value, is zero.
  template <class F>
  static double zero(F f, double low, double high) {
    const bool falls = f(low) > 0;
    for (int k = 0; k < 60 && high - low > std::numeric_limits<double>::epsilon(); ++k) {
      const double middle = (low + high) / 2;
      ((f(middle) > 0) == falls ? low : high) = middle;
    }
    return (low + high) / 2;
  }
};

}  // namespace poise
