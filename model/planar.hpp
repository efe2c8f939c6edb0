#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "model/select.hpp"

namespace poise {

/// pi in the scalar T, to its own precision; scalars that enclose sets of numbers specialise it.
template <class T>
T pi_of() {
  if constexpr (std::numeric_limits<T>::digits10 > std::numeric_limits<double>::digits10) {
    using std::atan;
    static const T value = T(4) * atan(T(1));
    return value;
  } else {
    return static_cast<T>(std::numbers::pi);
  }
}

/// A plane vector, also the complex number x + i y.
///
/// std::complex is unspecified for scalars other than the built-in ones, and Poise evaluates the same formulas
/// in double and in 50 digits, so the few operations needed are defined here.
template <class T>
struct Planar {
  T x{};
  T y{};

  friend Planar operator+(const Planar& a, const Planar& b) { return {a.x + b.x, a.y + b.y}; }
  friend Planar operator-(const Planar& a, const Planar& b) { return {a.x - b.x, a.y - b.y}; }
  friend Planar operator-(const Planar& a) { return {-a.x, -a.y}; }
  /// Complex product: a rotated by arg(b) and stretched by |b|.
  friend Planar operator*(const Planar& a, const Planar& b) { return {a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x}; }
  friend Planar operator*(const T& s, const Planar& a) { return {s * a.x, s * a.y}; }
  Planar& operator+=(const Planar& a) {
    x += a.x;
    y += a.y;
    return *this;
  }
  Planar& operator-=(const Planar& a) {
    x -= a.x;
    y -= a.y;
    return *this;
  }
  friend bool operator==(const Planar&, const Planar&) = default;
};

/// The same vector with its components converted to the scalar T.
template <class T, class S>
Planar<T> planar_cast(const Planar<S>& a) {
  return {static_cast<T>(a.x), static_cast<T>(a.y)};
}

/// Of scalars in lanes.
template <class T, int N>
Planar<T> select(const Mask<N>& condition, const Planar<T>& a, const Planar<T>& b) {
  return {select(condition, a.x, b.x), select(condition, a.y, b.y)};
}

/// i a: the vector rotated by a quarter turn counter-clockwise.
template <class T>
Planar<T> quarter_turn(const Planar<T>& a) {
  return {-a.y, a.x};
}

/// conj(a): the vector mirrored in the x axis.
template <class T>
Planar<T> conj(const Planar<T>& a) {
  return {a.x, -a.y};
}

/// Scalar product Re(conj(a) b) = ax bx + ay by.
template <class T>
T dot(const Planar<T>& a, const Planar<T>& b) {
  return a.x * b.x + a.y * b.y;
}

/// Cross product Im(conj(a) b) = ax by - ay bx: the moment of force b acting at the end of arm a.
template <class T>
T cross(const Planar<T>& a, const Planar<T>& b) {
  return a.x * b.y - a.y * b.x;
}

/// Euclidean length |a|.
template <class T>
T norm(const Planar<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}

/// exp(i angle): the unit vector at `angle` radians from +x, counter-clockwise.
template <class T>
Planar<T> unit(const T& angle) {
  using std::cos;
  using std::sin;
  return {cos(angle), sin(angle)};
}

/// The angle of a vector other than zero, counter-clockwise from the x axis, in [0, 2 pi).
template <class T>
T full_angle_of(const Planar<T>& a) {
  using std::atan2;
  T angle = atan2(a.y, a.x);
  return choose(
      angle < T(0), [&] { return T(angle + T(2) * pi_of<T>()); }, [&] { return angle; });
}

using Vec2 = Planar<double>;

/// a / |a|, computed in T; a is finite and not zero. No square over- or underflows.
template <class T>
Planar<T> direction(const Vec2& a) {
  const int exponent = std::ilogb(std::abs(a.x) > std::abs(a.y) ? a.x : a.y);
  const Planar<T> scaled = planar_cast<T>(Vec2{std::scalbn(a.x, -exponent), std::scalbn(a.y, -exponent)});
  const T length = norm(scaled);
  return {scaled.x / length, scaled.y / length};
}

}  // namespace poise
