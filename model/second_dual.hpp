#pragma once

#include <boost/math/differentiation/autodiff.hpp>

#include "model/plain_value.hpp"

namespace poise {

/// A function of two variables with its derivatives by each of them once, and by both:  f, f_a, f_b, f_ab.
using SecondDual = boost::math::differentiation::autodiff_fvar<double, 1, 1>;

/// A number of this value and these derivatives.
inline SecondDual second_dual(double value, double by_a, double by_b, double by_both = 0.0) {
  using boost::math::differentiation::make_fvar;
  static const SecondDual a = make_fvar<double, 1>(0.0) + SecondDual(0.0);
  static const SecondDual b = make_fvar<double, 0, 1>(0.0) + SecondDual(0.0);
  return SecondDual(value) + by_a * a + by_b * b + by_both * (a * b);
}

template <>
struct OtherDerivatives<SecondDual> {
  static double value(const SecondDual& x) { return x.derivative(0, 0); }
  static bool is_constant(const SecondDual& x) {
    return x.derivative(1, 0) == 0.0 && x.derivative(0, 1) == 0.0 && x.derivative(1, 1) == 0.0;
  }
};

}  // namespace poise
