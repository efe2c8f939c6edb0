#pragma once

#include <array>
#include <cmath>
#include <span>
#include <string_view>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/law_force.hpp"
#include "model/laws/powers.hpp"
#include "model/number.hpp"
#include "model/plain_value.hpp"

namespace poise {

/// Dry friction: T = F(|w|) tanh(w / width), w = dg/dt, regularized Coulomb friction, so that bodies creep instead of
/// sticking. With width 0 Coulomb friction itself, T = F(|w|) sign(w), which in motion also sticks: where w = 0 it
/// holds with any |T| <= F_s (motion/stick_slip.hpp). With |w| friction that slides falls from F_s to F (R. Stribeck
/// 1902):
///   constant:     F(u) = F = F_s,
///   drop:         F(u) = F as soon as it slides,
///   exponential:  F(u) = F + (F_s - F) exp(-(u/w_s)^d),
///   hyperbolic:   F(u) = F + (F_s - F) / (1 + u/w_s).
template <class N>
struct DryFrictionOf {
  enum class Falls { exponential, hyperbolic, drop, not_at_all };

  N force = N(0);              ///< F, of sliding: N or N m
  N width = N(0.01);           ///< m/s or rad/s
  N static_force = N(0);       ///< F_s, if it falls
  N stribeck_rate = N(1);      ///< w_s: m/s or rad/s, if it falls with the rate
  N stribeck_exponent = N(1);  ///< d, if it is exponential
  Falls falls = Falls::not_at_all;

  template <class P>
  DryFrictionOf<P> with(const P* p) const {
    DryFrictionOf<P> out{p[0], p[1]};
    out.falls = static_cast<typename DryFrictionOf<P>::Falls>(falls);
    if (falls != Falls::not_at_all) out.static_force = p[2];
    if (falls_with_rate()) out.stribeck_rate = p[3];
    if (falls == Falls::exponential) out.stribeck_exponent = p[4];
    return out;
  }

  bool sticks() const { return all(width == N(0)); }
  bool falls_with_rate() const { return falls == Falls::exponential || falls == Falls::hyperbolic; }
  /// The largest force with which it holds.
  const N& bound() const { return falls == Falls::not_at_all ? force : static_force; }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    using std::cosh;
    using std::tanh;
    if (is_just(bound(), 0.0)) return {};
    const S side = sign(rate);
    const Size<S> size = size_at(S(side * rate));
    return choose(
        width == N(0),
        [&] {
          return LawForce<S>{size.value * side, S(0), size.slope};
        },
        [&] {
          const S x = rate / S(width);
          // 1 / cosh^2 and not 1 - tanh^2, which is rounding at high rates.
          const S root = S(1) / cosh(x);
          return LawForce<S>{size.value * tanh(x), S(0),
                             size.value * root * root / S(width) + size.slope * side * tanh(x)};
        });
  }

  /// That of one that sticks while it slides in the direction 1 or -1, where its rate may be rounding; in 2 or -2 the
  /// force with which it begins to, F_s. None in 0.
  template <class S>
  LawForce<S> sliding(int direction, const S& rate) const {
    if (direction == 0) return {};
    const S side(direction > 0 ? 1 : -1);
    if (direction == 2 || direction == -2) return {side * S(bound()), S(0), S(0)};
    const Size<S> size = size_at(S(side * rate));
    return {side * size.value, S(0), size.slope};
  }

  template <class S>
  S force_by(int number, const S&, const S& rate) const {
    using std::cosh;
    using std::tanh;
    const S side = sign(rate), speed = side * rate;
    return choose(
        width == N(0), [&] { return number == 1 ? S(0) : S(side * size_by(number, speed)); },
        [&] {
          const S x = rate / S(width);
          if (number != 1) return S(tanh(x) * size_by(number, speed));
          const S root = S(1) / cosh(x);
          return S(-size_at(speed).value * root * root * x / S(width));
        });
  }

  /// The derivative of sliding() by a number.
  template <class S>
  S sliding_by(int number, int direction, const S& rate) const {
    if (direction == 0 || number == 1) return S(0);
    const S side(direction > 0 ? 1 : -1);
    if (direction == 2 || direction == -2) return number == (falls == Falls::not_at_all ? 0 : 2) ? side : S(0);
    return side * size_by(number, S(side * rate));
  }

  std::vector<N> rate_borders() const {
    return falls_with_rate() && !sticks() ? std::vector<N>{N(0)} : std::vector<N>{};
  }

  std::string_view idle() const { return {}; }

  // Its slope at rate zero is only due to the regularization.
  bool damps_small_motion() const { return false; }
  static constexpr std::string_view left_out =
      "nothing moves in statics; friction may also hold the mechanism in other positions, which are not searched";
  static constexpr std::array tables{LawTable{"friction"}};
  /// Force and width; all_numbers() has those that one that falls has behind them.
  static const std::array<Number, 2> numbers;
  /// The numbers behind these of one that falls, as many as it has.
  static const std::array<Number, 3> numbers_of_falling;
  std::span<const Number> all_numbers() const;

 private:
  template <class S>
  static S sign(const S& rate) {
    return select(rate > S(0), S(1), select(rate < S(0), S(-1), S(0)));
  }

  /// F(u) and dF/du.
  template <class S>
  struct Size {
    S value, slope;
  };
  template <class S>
  Size<S> size_at(const S& speed) const {
    if (!falls_with_rate()) return {S(force), S(0)};
    const Fall<S> fall = fall_at(speed);
    const S more = S(static_force) - S(force);
    return {S(force) + more * fall.left, more * fall.slope / S(stribeck_rate)};
  }
  template <class S>
  S size_by(int number, const S& speed) const {
    if (!falls_with_rate()) return number == 0 ? S(1) : S(0);
    const Fall<S> fall = fall_at(speed);
    if (number == 0) return S(1) - fall.left;
    if (number == 2) return fall.left;
    const S more = S(static_force) - S(force);
    if (number == 3) return -more * fall.slope * speed / (S(stribeck_rate) * S(stribeck_rate));
    return more * fall.by_exponent;
  }

  /// The part of F_s - F that is left at u = w_s x, and its derivatives by x and d.
  template <class S>
  struct Fall {
    S left, slope, by_exponent;
  };
  template <class S>
  Fall<S> fall_at(const S& speed) const {
    using std::exp;
    // Stages of a step may lie beyond the place where it stops sliding: there the formula goes on, so far as it may.
    const S x = choose(
        speed > -S(stribeck_rate) / S(2), [&] { return S(speed / S(stribeck_rate)); }, [] { return S(S(-1) / S(2)); });
    if (falls == Falls::hyperbolic) {
      const S left = S(1) / (S(1) + x);
      return {left, -left * left, S(0)};
    }
    const S d(stribeck_exponent);
    if (is_just(stribeck_exponent, 1.0)) {
      const S left = exp(-x);
      return {left, -left, S(0)};
    }
    const S size = choose(
        x < S(0), [&] { return S(-x); }, [&] { return S(x); });
    const S power = power_of(size, d);
    const S left = exp(-power);
    return {left, -left * d * power_of(size, S(d - S(1))), -left * power * log_of(size)};
  }
};

using DryFriction = DryFrictionOf<double>;

namespace friction_numbers {

inline void expect_static_above(const DryFriction& law, double static_force, double force) {
  if (law.falls == DryFriction::Falls::not_at_all || static_force >= force) return;
  throw InputError(
      "expected a static force of at least that of sliding; exchange them, or leave static out where both are equal");
}

inline constexpr std::array<Number, 5> all = [] {
  Number F = plain_number<&DryFriction::force>("force", {}, Range::not_negative);
  F.angle_key = "torque";
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  F.set = [](void* item, double value) {
    auto& law = *static_cast<DryFriction*>(item);
    expect_static_above(law, law.static_force, value);
    law.force = value;
  };
  Number w = plain_number<&DryFriction::width>("width", dimension::time.power(-1), Range::not_negative);
  w.measure_power = 1;
  Number Fs = plain_number<&DryFriction::static_force>("static", {}, Range::not_negative);
  Fs.effort_power = 1;
  Fs.needed = Number::Needed::always;
  Fs.set = [](void* item, double value) {
    auto& law = *static_cast<DryFriction*>(item);
    expect_static_above(law, value, law.force);
    law.static_force = value;
  };
  Number ws = plain_number<&DryFriction::stribeck_rate>("stribeck_rate", dimension::time.power(-1), Range::positive);
  ws.measure_power = 1;
  Number d = plain_number<&DryFriction::stribeck_exponent>("stribeck_exponent", {}, Range::positive);
  d.set = [](void* item, double value) {
    if (!(value >= 1.0)) throw InputError("expected an exponent of at least 1; below, friction falls at once at rest");
    static_cast<DryFriction*>(item)->stribeck_exponent = value;
  };
  return std::array{F, w, Fs, ws, d};
}();

}  // namespace friction_numbers

template <>
inline constexpr std::array<Number, 2> DryFrictionOf<double>::numbers{friction_numbers::all[0],
                                                                      friction_numbers::all[1]};
template <>
inline constexpr std::array<Number, 3> DryFrictionOf<double>::numbers_of_falling{
    friction_numbers::all[2], friction_numbers::all[3], friction_numbers::all[4]};

template <>
inline std::span<const Number> DryFrictionOf<double>::all_numbers() const {
  constexpr std::size_t counts[] = {5, 4, 3, 2};  // by Falls
  return std::span(friction_numbers::all).first(counts[static_cast<std::size_t>(falls)]);
}

}  // namespace poise
