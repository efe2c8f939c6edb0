#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "model/laws/law_force.hpp"
#include "model/laws/one_way.hpp"
#include "model/number.hpp"

namespace poise {

/// Viscous damper: T = c dg/dt. One that acts in tension (compression) only has no force while g shrinks (grows).
template <class N>
struct DamperOf {
  using Acts = SpringActs;
  N coefficient = N(0);  ///< c: N s/m or N m s/rad
  Acts acts = Acts::both;

  template <class P>
  DamperOf<P> with(const P* p) const {
    return {p[0], acts};
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    return while_it_acts(acts, rate, [&](const S& w) { return LawForce<S>{S(coefficient) * w, S(0), S(coefficient)}; });
  }

  template <class S>
  S force_by(int, const S&, const S& rate) const {
    return while_it_acts(acts, rate, [](const S& w) { return w; });
  }

  std::vector<N> rate_borders() const { return acts == Acts::both ? std::vector<N>{} : std::vector<N>{N(0)}; }

  std::string_view idle() const { return {}; }

  bool damps_small_motion() const { return acts == Acts::both; }
  static constexpr std::string_view left_out = "nothing moves in statics";
  static constexpr std::array in_motion{&DamperOf::coefficient};  ///< see with_more()
  static constexpr std::array tables{LawTable{"damper"}, LawTable{"torsion_damper", true}};
  static const std::array<Number, 1> numbers;
  static const std::array<LawChoice, 1> choices;
};

using Damper = DamperOf<double>;

template <>
inline constexpr std::array<LawChoice, 1> DamperOf<double>::choices{acts_choice<Damper>()};

template <>
inline constexpr std::array<Number, 1> DamperOf<double>::numbers = [] {
  Number c = plain_number<&Damper::coefficient>("coefficient", dimension::time, Range::not_negative);
  c.effort_power = 1;
  c.measure_power = -1;
  c.needed = Number::Needed::always;
  return std::array{c};
}();

}  // namespace poise
