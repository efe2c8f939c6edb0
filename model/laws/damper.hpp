#pragma once

#include <array>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Viscous damper: T = c dg/dt.
template <class N>
struct DamperOf {
  N coefficient = N(0);  ///< c: N s/m or N m s/rad

  template <class P>
  DamperOf<P> with(const P* p) const {
    return {p[0]};
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    return {S(coefficient) * rate, S(0), S(coefficient)};
  }

  template <class S>
  S force_by(int, const S&, const S& rate) const {
    return rate;
  }

  std::string_view idle() const { return {}; }

  static constexpr bool damps_small_motion = true;
  static constexpr std::string_view left_out = "nothing moves in statics";
  static constexpr std::array tables{LawTable{"damper"}, LawTable{"torsion_damper", true}};
  static const std::array<Number, 1> numbers;
};

using Damper = DamperOf<double>;

template <>
inline constexpr std::array<Number, 1> DamperOf<double>::numbers = [] {
  Number c = plain_number<&Damper::coefficient>("coefficient", dimension::time, Range::not_negative);
  c.effort_power = 1;
  c.measure_power = -1;
  c.needed = Number::Needed::always;
  return std::array{c};
}();

}  // namespace poise
