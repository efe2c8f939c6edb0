#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Dry friction: T = F tanh((dg/dt) / width), regularized Coulomb friction, so that bodies creep instead of sticking.
/// With width 0 Coulomb friction itself, T = F sign(dg/dt), which in motion also sticks: where dg/dt = 0 it holds with
/// any |T| <= F (motion/stick_slip.hpp).
template <class N>
struct DryFrictionOf {
  N force = N(0);     ///< F, of sliding: N or N m
  N width = N(0.01);  ///< m/s or rad/s

  template <class P>
  DryFrictionOf<P> with(const P* p) const {
    return {p[0], p[1]};
  }

  bool sticks() const { return all(width == N(0)); }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    using std::cosh;
    using std::tanh;
    if (is_just(force, 0.0)) return {};
    return choose(
        width == N(0),
        [&] {
          return LawForce<S>{S(force) * sign(rate), S(0), S(0)};
        },
        [&] {
          const S x = rate / S(width);
          // 1 / cosh^2 and not 1 - tanh^2, which is rounding at high rates.
          const S root = S(1) / cosh(x);
          return LawForce<S>{S(force) * tanh(x), S(0), S(force) * root * root / S(width)};
        });
  }

  template <class S>
  S force_by(int number, const S& g, const S& rate) const {
    using std::tanh;
    return choose(
        width == N(0), [&] { return number == 0 ? sign(rate) : S(0); },
        [&] { return S(number == 0 ? S(tanh(rate / S(width))) : S(-resisting(g, rate).by_rate * rate / S(width))); });
  }

  std::string_view idle() const { return {}; }

  // Its slope at rate zero is only due to the regularization.
  static constexpr bool damps_small_motion = false;
  static constexpr std::string_view left_out =
      "nothing moves in statics; friction may also hold the mechanism in other positions, which are not searched";
  static constexpr std::array tables{LawTable{"friction"}};
  static const std::array<Number, 2> numbers;

 private:
  template <class S>
  static S sign(const S& rate) {
    return select(rate > S(0), S(1), select(rate < S(0), S(-1), S(0)));
  }
};

using DryFriction = DryFrictionOf<double>;

template <>
inline constexpr std::array<Number, 2> DryFrictionOf<double>::numbers = [] {
  Number F = plain_number<&DryFriction::force>("force", {}, Range::not_negative);
  F.angle_key = "torque";
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  Number w = plain_number<&DryFriction::width>("width", dimension::time.power(-1), Range::not_negative);
  w.measure_power = 1;
  return std::array{F, w};
}();

}  // namespace poise
