#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

#include "model/planar.hpp"
#include "model/select.hpp"

namespace poise {

/// In which lanes of a Pack something is true. It is no bool: what branches by it has to say all() or any(), or chooses
/// in each lane (select(), choose()). Both sides of && and || are evaluated.
template <int N>
class Mask {
 public:
  Mask() = default;
  /// All lanes have this value.
  explicit Mask(bool value) { is_.fill(value); }

  bool operator[](int lane) const { return is_[static_cast<std::size_t>(lane)]; }
  bool& operator[](int lane) { return is_[static_cast<std::size_t>(lane)]; }

  friend Mask operator!(const Mask& a) {
    return of_each([&](int l) { return !a[l]; });
  }
  friend Mask operator&&(const Mask& a, const Mask& b) {
    return of_each([&](int l) { return a[l] && b[l]; });
  }
  friend Mask operator||(const Mask& a, const Mask& b) {
    return of_each([&](int l) { return a[l] || b[l]; });
  }

  friend bool all(const Mask& a) {
    bool out = true;
    for (const bool one : a.is_) out = out && one;
    return out;
  }
  friend bool any(const Mask& a) {
    bool out = false;
    for (const bool one : a.is_) out = out || one;
    return out;
  }

  /// With f(lane) in each lane.
  template <class F>
  static Mask of_each(F f) {
    Mask out;
    for (int l = 0; l < N; ++l) out[l] = f(l);
    return out;
  }

 private:
  std::array<bool, static_cast<std::size_t>(N)> is_{};
};

/// N numbers at once, one in each lane, on which all operations act lane by lane as they do on T: N variants of a scene
/// that are evaluated together, without derivatives. In each lane a formula has the result that it has in T; where it
/// is written with select(), choose() or by_pieces() lanes may be on different sides, or in different pieces. What such
/// a choice leaves out may be infinite or not a number.
///
/// The structure of what is evaluated is that of all lanes: a number counts as zero (is_just()) where it is so in all.
template <class T, int N>
class Pack {
 public:
  Pack() = default;
  /// All lanes have this value.
  Pack(const T& value) { at_.fill(value); }

  const T& operator[](int lane) const { return at_[static_cast<std::size_t>(lane)]; }
  T& operator[](int lane) { return at_[static_cast<std::size_t>(lane)]; }

  /// With f(lane) in each lane.
  template <class F>
  static Pack of_each(F f) {
    Pack out;
    for (int l = 0; l < N; ++l) out[l] = f(l);
    return out;
  }

  friend Pack operator+(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return a[l] + b[l]; });
  }
  friend Pack operator-(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return a[l] - b[l]; });
  }
  friend Pack operator*(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return a[l] * b[l]; });
  }
  friend Pack operator/(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return a[l] / b[l]; });
  }
  friend Pack operator-(const Pack& a) {
    return of_each([&](int l) { return -a[l]; });
  }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }

  friend Mask<N> operator==(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] == b[l]; });
  }
  friend Mask<N> operator!=(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] != b[l]; });
  }
  friend Mask<N> operator<(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] < b[l]; });
  }
  friend Mask<N> operator>(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] > b[l]; });
  }
  friend Mask<N> operator<=(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] <= b[l]; });
  }
  friend Mask<N> operator>=(const Pack& a, const Pack& b) {
    return Mask<N>::of_each([&](int l) { return a[l] >= b[l]; });
  }

  friend Pack sqrt(const Pack& a) {
    using std::sqrt;
    return of_each([&](int l) { return sqrt(a[l]); });
  }
  friend Pack abs(const Pack& a) {
    using std::abs;
    return of_each([&](int l) { return abs(a[l]); });
  }
  friend Pack floor(const Pack& a) {
    using std::floor;
    return of_each([&](int l) { return floor(a[l]); });
  }
  friend Pack sin(const Pack& a) {
    using std::sin;
    return of_each([&](int l) { return sin(a[l]); });
  }
  friend Pack cos(const Pack& a) {
    using std::cos;
    return of_each([&](int l) { return cos(a[l]); });
  }
  friend Pack tan(const Pack& a) {
    using std::tan;
    return of_each([&](int l) { return tan(a[l]); });
  }
  friend Pack atan(const Pack& a) {
    using std::atan;
    return of_each([&](int l) { return atan(a[l]); });
  }
  friend Pack atan2(const Pack& a, const Pack& b) {
    using std::atan2;
    return of_each([&](int l) { return atan2(a[l], b[l]); });
  }
  friend Pack exp(const Pack& a) {
    using std::exp;
    return of_each([&](int l) { return exp(a[l]); });
  }
  friend Pack expm1(const Pack& a) {
    using std::expm1;
    return of_each([&](int l) { return expm1(a[l]); });
  }
  friend Pack log(const Pack& a) {
    using std::log;
    return of_each([&](int l) { return log(a[l]); });
  }
  friend Pack log1p(const Pack& a) {
    using std::log1p;
    return of_each([&](int l) { return log1p(a[l]); });
  }
  friend Pack pow(const Pack& a, const Pack& b) {
    using std::pow;
    return of_each([&](int l) { return pow(a[l], b[l]); });
  }
  friend Pack sinh(const Pack& a) {
    using std::sinh;
    return of_each([&](int l) { return sinh(a[l]); });
  }
  friend Pack cosh(const Pack& a) {
    using std::cosh;
    return of_each([&](int l) { return cosh(a[l]); });
  }
  friend Pack tanh(const Pack& a) {
    using std::tanh;
    return of_each([&](int l) { return tanh(a[l]); });
  }
  friend Pack min(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return b[l] < a[l] ? b[l] : a[l]; });
  }
  friend Pack max(const Pack& a, const Pack& b) {
    return of_each([&](int l) { return a[l] < b[l] ? b[l] : a[l]; });
  }

 private:
  std::array<T, static_cast<std::size_t>(N)> at_{};
};

template <class T, int N>
inline constexpr bool has_lanes<Pack<T, N>> = true;

template <class T, int N>
struct LaneOfScalar<Pack<T, N>> {
  using Type = T;
};

/// The number in a lane; a scalar without lanes is the same in all.
template <class T, int N>
const T& lane_of(const Pack<T, N>& x, int lane) {
  return x[lane];
}
template <class T>
const T& lane_of(const T& x, int /*lane*/) {
  return x;
}

/// a in the lanes in which the condition holds, b in the others.
template <class T, int N>
Pack<T, N> select(const Mask<N>& condition, const Pack<T, N>& a, const Pack<T, N>& b) {
  return Pack<T, N>::of_each([&](int l) { return condition[l] ? a[l] : b[l]; });
}

template <class T, int N>
Pack<T, N> zero_where(const Mask<N>& condition, const Pack<T, N>& x) {
  return select(condition, Pack<T, N>(T(0)), x);
}

template <int N, class A, class B>
std::invoke_result_t<A> choose(const Mask<N>& condition, A a, B b) {
  if (all(condition)) return a();
  if (!any(condition)) return b();
  return select(condition, a(), b());
}

/// Sine and cosine together, which is faster than one after the other.
template <class T, int N>
Planar<Pack<T, N>> unit(const Pack<T, N>& angle) {
  Planar<Pack<T, N>> out;
  for (int l = 0; l < N; ++l) {
    const Planar<T> one = unit(angle[l]);
    out.x[l] = one.x;
    out.y[l] = one.y;
  }
  return out;
}

/// in_piece() of lanes.
template <class T, int N, class Find, class Piece>
auto in_pieces_of_lanes(const Pack<T, N>& /*scalar*/, Find find, Piece piece) {
  std::array<std::size_t, static_cast<std::size_t>(N)> in{};
  for (std::size_t l = 0; l < in.size(); ++l) {
    in[l] = find([l](const auto& x) -> const auto& { return lane_of(x, static_cast<int>(l)); });
  }
  auto out = piece(in[0]);
  for (std::size_t l = 1; l < in.size(); ++l) {
    bool is_known = false;
    for (std::size_t before = 0; before < l; ++before) is_known = is_known || in[before] == in[l];
    if (is_known) continue;
    const auto is_in = Mask<N>::of_each([&](int other) { return in[static_cast<std::size_t>(other)] == in[l]; });
    out = select(is_in, piece(in[l]), out);
  }
  return out;
}

}  // namespace poise

template <class T, int N>
struct std::numeric_limits<poise::Pack<T, N>> : std::numeric_limits<T> {};
