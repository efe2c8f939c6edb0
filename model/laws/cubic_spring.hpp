#pragma once

#include <array>
#include <cmath>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Hardening (c > 0) or softening (c < 0) spring:  T = k u + c u^3,  V = k/2 u^2 + c/4 u^4,  with u = g - g0.
template <class N>
struct CubicSpringOf {
  N stiffness = N(0);    ///< k: N/m or N m/rad
  N cubic = N(0);        ///< c: N/m^3 or N m/rad^3
  N free_length = N(0);  ///< g0: m or rad

  template <class P>
  CubicSpringOf<P> with(const P* p) const {
    return {p[0], p[1], p[2]};
  }

  template <class S>
  S energy(const S& g) const {
    const S uu = (g - S(free_length)) * (g - S(free_length));
    return (S(stiffness) / S(2) + S(cubic) * uu / S(4)) * uu;
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    const S u = g - S(free_length);
    const S uu = u * u;
    return {(S(stiffness) + S(cubic) * uu) * u, S(stiffness) + S(3) * S(cubic) * uu, S(0)};
  }

  template <class S>
  S force_by(int number, const S& g, const S&) const {
    S u = g - S(free_length);
    if (number == 0) return u;
    return number == 1 ? S(u * u * u) : S(-at_rest(g).by_measure);
  }

  double force_scale(double change) const { return (stiffness + std::abs(cubic) * change * change) * change; }

  std::string_view idle() const { return stiffness == 0.0 && cubic == 0.0 ? "its stiffness is zero" : ""; }

  static constexpr int affine_numbers = 2;
  static constexpr std::array in_motion{&CubicSpringOf::stiffness, &CubicSpringOf::cubic,
                                        &CubicSpringOf::free_length};  ///< see with_more()
  static constexpr std::array tables{LawTable{"spring", false, "cubic"}, LawTable{"torsion_spring", true, "cubic"},
                                     LawTable{"cubic_spring"}};
  static const std::array<Number, 3> numbers;
};

using CubicSpring = CubicSpringOf<double>;

template <>
inline constexpr std::array<Number, 3> CubicSpringOf<double>::numbers = [] {
  Number k = plain_number<&CubicSpring::stiffness>("stiffness", {}, Range::not_negative);
  k.effort_power = 1;
  k.measure_power = -1;
  k.needed = Number::Needed::always;
  Number c = plain_number<&CubicSpring::cubic>("cubic", {});
  c.effort_power = 1;
  c.measure_power = -3;
  c.needed = Number::Needed::always;
  Number g0 = plain_number<&CubicSpring::free_length>("free_length", {});
  g0.angle_key = "free_angle";
  g0.measure_power = 1;
  g0.range_of_measure = true;
  g0.needed = Number::Needed::as_length;
  return std::array{k, c, g0};
}();

}  // namespace poise
