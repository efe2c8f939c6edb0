#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Linear spring given by its force at one length:  T = F + k u,  V = F u + k/2 u^2,  with u = g - L: the force F
/// (moment) at the length (angle) L. V is counted from there.
template <class N>
struct PreloadedSpringOf {
  N stiffness = N(0);  ///< k: N/m or N m/rad
  N preload = N(0);    ///< F: N or N m
  N length = N(0);     ///< L: m or rad

  template <class P>
  PreloadedSpringOf<P> with(const P* p) const {
    return {p[0], p[1], p[2]};
  }

  template <class S>
  S energy(const S& g) const {
    const S u = g - S(length);
    return (S(preload) + S(stiffness) * u / S(2)) * u;
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    return {S(preload) + S(stiffness) * (g - S(length)), S(stiffness), S(0)};
  }

  template <class S>
  S force_by(int number, const S& g, const S&) const {
    if (number == 0) return g - S(length);
    return number == 1 ? S(1) : S(-S(stiffness));
  }

  double force_scale(double change) const { return std::abs(preload) + stiffness * change; }

  std::string_view idle() const {
    return stiffness == 0.0 && preload == 0.0 ? "its stiffness and its preload are zero" : "";
  }

  static constexpr std::array in_motion{&PreloadedSpringOf::stiffness, &PreloadedSpringOf::preload,
                                        &PreloadedSpringOf::length};  ///< see with_more()
  static constexpr std::array tables{LawTable{"spring", false, "preload"}, LawTable{"torsion_spring", true, "preload"}};
  static const std::array<Number, 3> numbers;
};

using PreloadedSpring = PreloadedSpringOf<double>;

template <>
inline constexpr std::array<Number, 3> PreloadedSpringOf<double>::numbers = [] {
  Number k = plain_number<&PreloadedSpring::stiffness>("stiffness", {}, Range::not_negative);
  k.effort_power = 1;
  k.measure_power = -1;
  k.needed = Number::Needed::always;
  Number F = plain_number<&PreloadedSpring::preload>("preload", {});
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  Number L = plain_number<&PreloadedSpring::length>("length", {});
  L.angle_key = "angle";
  L.measure_power = 1;
  L.range_of_measure = true;
  L.needed = Number::Needed::always;
  return std::array{k, F, L};
}();

}  // namespace poise
