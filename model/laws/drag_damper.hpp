#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "model/laws/law_force.hpp"
#include "model/laws/one_way.hpp"
#include "model/number.hpp"

namespace poise {

/// Drag, as of air, water, or an orifice: T = c w + d w |w| with w = dg/dt. One that acts in tension (compression) only
/// has no force while g shrinks (grows).
template <class N>
struct DragDamperOf {
  using Acts = SpringActs;
  N coefficient = N(0);  ///< c: N s/m or N m s/rad
  N drag = N(0);         ///< d: N s^2/m^2 or N m s^2/rad^2
  Acts acts = Acts::both;

  template <class P>
  DragDamperOf<P> with(const P* p) const {
    return {p[0], p[1], acts};
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& rate) const {
    return while_it_acts(acts, rate, [&](const S& w) {
      const S speed = size_of(w);
      return LawForce<S>{(S(coefficient) + S(drag) * speed) * w, S(0), S(coefficient) + S(2) * S(drag) * speed};
    });
  }

  template <class S>
  S force_by(int number, const S&, const S& rate) const {
    return while_it_acts(acts, rate, [&](const S& w) { return number == 0 ? w : S(size_of(w) * w); });
  }

  std::vector<N> rate_borders() const { return {N(0)}; }

  std::string_view idle() const { return {}; }

  bool damps_small_motion() const { return acts == Acts::both; }
  static constexpr std::string_view left_out = "nothing moves in statics";
  static constexpr std::array in_motion{&DragDamperOf::coefficient, &DragDamperOf::drag};  ///< see with_more()
  static constexpr std::array tables{LawTable{"damper", false, "drag"}, LawTable{"torsion_damper", true, "drag"}};
  static const std::array<Number, 2> numbers;
  static const std::array<LawChoice, 1> choices;

 private:
  template <class S>
  static S size_of(const S& rate) {
    return by_pieces(rate, std::array{0.0},
                     [](std::size_t grows, const S& part) { return grows != 0 ? part : S(-part); });
  }
};

using DragDamper = DragDamperOf<double>;

template <>
inline constexpr std::array<LawChoice, 1> DragDamperOf<double>::choices{acts_choice<DragDamper>()};

template <>
inline constexpr std::array<Number, 2> DragDamperOf<double>::numbers = [] {
  Number c = plain_number<&DragDamper::coefficient>("coefficient", dimension::time, Range::not_negative);
  c.effort_power = 1;
  c.measure_power = -1;
  Number d = plain_number<&DragDamper::drag>("drag", dimension::time.power(2), Range::not_negative);
  d.effort_power = 1;
  d.measure_power = -2;
  d.needed = Number::Needed::always;
  return std::array{c, d};
}();

}  // namespace poise
