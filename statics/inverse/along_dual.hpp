#pragma once

#include <array>
#include <cmath>
#include <type_traits>

#include "model/layout.hpp"
#include "model/plain_value.hpp"
#include "model/set_valued.hpp"
#include "statics/bodies/ball_scalar.hpp"

namespace poise {

/// A number a that depends on N variables and on one more, t: its derivative w by t, `by` each variable, and the mixed
/// ones m. Of T = double or Ball. Where pieces of a law meet in balls comparisons are not decided (Ball::Undecided).
template <class T, int N>
struct AlongDual {
  T a{}, w{};
  std::array<T, N> by{}, m{};

  AlongDual() { clear(); }
  AlongDual(int number) : a(number) { clear(); }     // NOLINT(google-explicit-constructor)
  AlongDual(double number) : a(number) { clear(); }  // NOLINT(google-explicit-constructor)
  explicit AlongDual(const T& number) requires(!std::is_same_v<T, double>) : a(number) { clear(); }

  /// f of this, with the derivatives f' and f'' there.
  AlongDual with(const T& f, const T& first, const T& second) const {
    AlongDual out;
    out.a = f;
    out.w = first * w;
    for (std::size_t k = 0; k < N; ++k) {
      out.by[k] = first * by[k];
      out.m[k] = first * m[k] + second * w * by[k];
    }
    return out;
  }

  AlongDual operator-() const { return with(-a, T(-1), T(0)); }
  friend AlongDual operator+(AlongDual x, const AlongDual& y) { return x += y; }
  friend AlongDual operator-(AlongDual x, const AlongDual& y) { return x -= y; }
  friend AlongDual operator*(const AlongDual& x, const AlongDual& y) {
    AlongDual out;
    out.a = x.a * y.a;
    out.w = x.w * y.a + x.a * y.w;
    for (std::size_t k = 0; k < N; ++k) {
      out.by[k] = x.by[k] * y.a + x.a * y.by[k];
      out.m[k] = x.m[k] * y.a + x.w * y.by[k] + x.by[k] * y.w + x.a * y.m[k];
    }
    return out;
  }
  friend AlongDual operator/(const AlongDual& x, const AlongDual& y) {
    const T over = T(1) / y.a;
    return x * y.with(over, -(over * over), T(2) * over * over * over);
  }
  AlongDual& operator+=(const AlongDual& y) {
    a = a + y.a;
    w = w + y.w;
    for (std::size_t k = 0; k < N; ++k) {
      by[k] = by[k] + y.by[k];
      m[k] = m[k] + y.m[k];
    }
    return *this;
  }
  AlongDual& operator-=(const AlongDual& y) { return *this += -y; }
  AlongDual& operator*=(const AlongDual& y) { return *this = *this * y; }
  AlongDual& operator/=(const AlongDual& y) { return *this = *this / y; }

  friend bool operator<(const AlongDual& x, const AlongDual& y) { return x.a < y.a; }
  friend bool operator>(const AlongDual& x, const AlongDual& y) { return x.a > y.a; }
  friend bool operator<=(const AlongDual& x, const AlongDual& y) { return x.a <= y.a; }
  friend bool operator>=(const AlongDual& x, const AlongDual& y) { return x.a >= y.a; }
  friend bool operator==(const AlongDual& x, const AlongDual& y) { return x.a == y.a; }

  friend AlongDual sqrt(const AlongDual& x) {
    using std::sqrt;
    const T root = sqrt(x.a), first = T(1) / (T(2) * root);
    return x.with(root, first, -(first / (T(2) * x.a)));
  }
  friend AlongDual sin(const AlongDual& x) {
    using std::cos;
    using std::sin;
    const T sine = sin(x.a);
    return x.with(sine, cos(x.a), -sine);
  }
  friend AlongDual cos(const AlongDual& x) {
    using std::cos;
    using std::sin;
    const T cosine = cos(x.a);
    return x.with(cosine, -sin(x.a), -cosine);
  }
  friend AlongDual exp(const AlongDual& x) {
    using std::exp;
    const T value = exp(x.a);
    return x.with(value, value, value);
  }
  friend AlongDual log(const AlongDual& x) {
    using std::log;
    const T over = T(1) / x.a;
    return x.with(log(x.a), over, -(over * over));
  }
  /// |x|, of balls with both slopes where x may have either sign.
  friend AlongDual abs(const AlongDual& x) {
    using std::abs;
    using std::copysign;
    return x.with(abs(x.a), copysign(T(1), x.a), T(0));
  }
  /// A step, which has no derivatives but zero; of T = double.
  friend AlongDual floor(const AlongDual& x) requires std::is_same_v<T, double> { return {std::floor(x.a)}; }
  /// The angle of the vector (x, y): its derivatives are those of  (x dy - y dx) / (x^2 + y^2).
  friend AlongDual atan2(const AlongDual& y, const AlongDual& x) {
    using std::atan2;
    const AlongDual square = x * x + y * y;
    AlongDual out(0);
    out.a = atan2(y.a, x.a);
    out.w = (x.a * y.w - y.a * x.w) / square.a;
    for (std::size_t k = 0; k < N; ++k) {
      out.by[k] = (x.a * y.by[k] - y.a * x.by[k]) / square.a;
      const T change = x.by[k] * y.w + x.a * y.m[k] - y.by[k] * x.w - y.a * x.m[k];
      out.m[k] = (change - out.w * square.by[k]) / square.a;
    }
    return out;
  }

 private:
  void clear() {
    w = T(0);
    by.fill(T(0));
    m.fill(T(0));
  }
};

template <class T, int N>
struct OtherDerivatives<AlongDual<T, N>> {
  static const T& value(const AlongDual<T, N>& x) { return x.a; }
  static bool is_constant(const AlongDual<T, N>& x) {
    bool out = is_just(x.w, 0.0);
    for (std::size_t k = 0; k < N; ++k) out = out && is_just(x.by[k], 0.0) && is_just(x.m[k], 0.0);
    return out;
  }
};

/// Enclosures with those of their derivatives.
using BallAlong = AlongDual<Ball, 4>;

template <>
inline BallAlong hull(const BallAlong& a, const BallAlong& b) {
  BallAlong out(Ball::of_both(a.a, b.a));
  out.w = Ball::of_both(a.w, b.w);
  for (std::size_t k = 0; k < 4; ++k) {
    out.by[k] = Ball::of_both(a.by[k], b.by[k]);
    out.m[k] = Ball::of_both(a.m[k], b.m[k]);
  }
  return out;
}

template <>
inline BallAlong middle_of(const BallAlong& a) {
  return BallAlong(a.a.midpoint());
}

template <>
inline BallAlong pi_of() {
  return BallAlong(Ball::pi());
}

template <>
inline BallAlong full_angle_of(const Planar<BallAlong>& a) {
  BallAlong out = atan2(a.y, a.x);
  out.a = full_angle_of(Planar<Ball>{a.x.a, a.y.a});
  return out;
}

}  // namespace poise
