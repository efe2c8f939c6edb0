#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "model/input_error.hpp"
#include "model/laws/law_force.hpp"
#include "model/laws/one_way.hpp"
#include "model/laws/powers.hpp"
#include "model/number.hpp"

namespace poise {

/// Progressive bump stop: T = F (|u|/d)^p sign(u), V = F d/(p + 1) (|u|/d)^(p + 1), with u = g - g0: the force F at the
/// depth d beyond the place g0 where contact begins. One that acts in compression (tension) only has no force while g
/// is above (below) g0. With p > 1 force and slope are continuous there: it has no kink.
template <class N>
struct BumpStopOf {
  using Acts = SpringActs;
  N force = N(0);        ///< F: N or N m
  N free_length = N(0);  ///< g0: m or rad
  N depth = N(1);        ///< d: m or rad
  N exponent = N(2);     ///< p
  Acts acts = Acts::compression;

  template <class P>
  BumpStopOf<P> with(const P* p) const {
    return {p[0], p[1], p[2], p[3], acts};
  }

  template <class S>
  auto slack(const S& g) const {
    using Condition = decltype(g <= S(free_length));
    if (acts == Acts::both) return Condition(false);
    return acts == Acts::tension ? g <= S(free_length) : g >= S(free_length);
  }

  template <class S>
  S energy(const S& g) const {
    return pieces(g, [&](const S& y, double) {
      return S(force) * S(depth) / (S(exponent) + S(1)) * power_of(y, S(S(exponent) + S(1)));
    });
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    return pieces(g, [&](const S& y, double side) {
      const S slope = S(force) * power_of(y, S(S(exponent) - S(1)));
      return LawForce<S>{S(side) * slope * y, slope * S(exponent) / S(depth), S(0)};
    });
  }

  template <class S>
  S force_by(int number, const S& g, const S&) const {
    if (number == 1) return -at_rest(g).by_measure;
    return pieces(g, [&](const S& y, double side) -> S {
      S unit = S(side) * power_of(y, S(exponent));
      if (number == 0) return unit;
      if (number == 2) return -S(force) * S(exponent) / S(depth) * unit;
      return S(force) * unit * log_of(y);
    });
  }

  std::vector<N> measure_borders() const { return {free_length}; }

  double force_scale(double) const { return force; }

  std::string_view idle() const { return force == 0.0 ? "its force is zero" : ""; }

  static constexpr int affine_numbers = 1;
  static constexpr std::array tables{LawTable{"bump_stop"}};
  static const std::array<Number, 4> numbers;
  static const std::array<LawChoice, 1> choices;

 private:
  // f(y, side) on the sides that act, y >= 0 the penetration in depths; zero of its kind elsewhere.
  template <class S, class F>
  auto pieces(const S& g, F f) const {
    const S u = (g - S(free_length)) / S(depth);
    return by_pieces(u, std::array{0.0}, [&](std::size_t piece, const S& part) {
      if (piece == 0) return acts == Acts::tension ? decltype(f(u, 1.0)){} : f(S(-part), -1.0);
      return acts == Acts::compression ? decltype(f(u, 1.0)){} : f(part, 1.0);
    });
  }
};

using BumpStop = BumpStopOf<double>;

template <>
inline constexpr std::array<LawChoice, 1> BumpStopOf<double>::choices{
    {{"acts", {"compression", "tension", "both"}, [](void* law, std::size_t word) {
        constexpr Acts meanings[] = {Acts::compression, Acts::tension, Acts::both};
        static_cast<BumpStop*>(law)->acts = meanings[word];
      }}}};

template <>
inline constexpr std::array<Number, 4> BumpStopOf<double>::numbers = [] {
  Number F = plain_number<&BumpStop::force>("force", {}, Range::not_negative);
  F.angle_key = "torque";
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  Number g0 = plain_number<&BumpStop::free_length>("free_length", {});
  g0.angle_key = "free_angle";
  g0.measure_power = 1;
  g0.range_of_measure = true;
  g0.needed = Number::Needed::as_length;
  Number d = plain_number<&BumpStop::depth>("depth", {}, Range::positive);
  d.measure_power = 1;
  d.needed = Number::Needed::always;
  Number p = plain_number<&BumpStop::exponent>("exponent", {}, Range::positive);
  p.set = [](void* item, double value) {
    if (!(value > 1.0)) {
      throw InputError("expected an exponent above 1; a stop of constant stiffness is a spring with acts = \"...\"");
    }
    static_cast<BumpStop*>(item)->exponent = value;
  };
  return std::array{F, g0, d, p};
}();

}  // namespace poise
