#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "model/laws/law_force.hpp"
#include "model/laws/one_way.hpp"
#include "model/number.hpp"

namespace poise {

/// Linear spring: T = k (g - g0), V = k/2 (g - g0)^2, with the free length (free angle) g0. One that acts in tension
/// (compression) only is slack, without force or energy, while g is below (above) g0.
template <class N>
struct LinearSpringOf {
  using Acts = SpringActs;
  N stiffness = N(0);    ///< k: N/m or N m/rad
  N free_length = N(0);  ///< g0: m or rad
  Acts acts = Acts::both;

  template <class P>
  LinearSpringOf<P> with(const P* p) const {
    return {p[0], p[1], acts};
  }

  template <class S>
  auto slack(const S& g) const {
    using Condition = decltype(g <= S(free_length));
    if (acts == Acts::both) return Condition(false);
    return acts == Acts::tension ? g <= S(free_length) : g >= S(free_length);
  }

  template <class S>
  S energy(const S& g) const {
    return choose(
        slack(g), [] { return S(0); },
        [&] {
          const S stretch = g - S(free_length);
          return S(S(stiffness) * stretch * stretch / S(2));
        });
  }

  template <class S>
  LawForce<S> at_rest(const S& g) const {
    return choose(
        slack(g), [] { return LawForce<S>{}; }, [&] { return not_slack(g); });
  }

  template <class S>
  S force_by(int number, const S& g, const S&) const {
    return choose(
        slack(g), [] { return S(0); }, [&] { return number == 0 ? S(g - S(free_length)) : S(-S(stiffness)); });
  }

  std::vector<N> measure_borders() const { return acts == Acts::both ? std::vector<N>{} : std::vector<N>{free_length}; }

  /// Size of the force for a change `change` of g: sets the scale of a scene without loads.
  double force_scale(double change) const { return stiffness * change; }

  std::string_view idle() const { return stiffness == 0.0 ? "its stiffness is zero" : ""; }

  static constexpr std::array in_motion{&LinearSpringOf::stiffness, &LinearSpringOf::free_length};  ///< see with_more()
  static constexpr std::array tables{LawTable{"spring"}, LawTable{"torsion_spring", true}};
  static const std::array<Number, 2> numbers;
  static const std::array<LawChoice, 1> choices;

 private:
  // at_rest() where it acts, or in sets of measures may act.
  template <class S>
  LawForce<S> not_slack(const S& g) const {
    const S stretch = g - S(free_length);
    if constexpr (may_enclose_set<S>) {
      if (acts == Acts::tension && !(g > S(free_length))) {
        return {S(stiffness) * not_below_zero(stretch), S(stiffness) * with_zero(S(1)), S(0)};
      }
      if (acts == Acts::compression && !(g < S(free_length))) {
        return {-(S(stiffness) * not_below_zero(S(-stretch))), S(stiffness) * with_zero(S(1)), S(0)};
      }
    }
    return {S(stiffness) * stretch, S(stiffness), S(0)};
  }
};

using LinearSpring = LinearSpringOf<double>;

template <>
inline constexpr std::array<LawChoice, 1> LinearSpringOf<double>::choices{acts_choice<LinearSpring>()};

template <>
inline constexpr std::array<Number, 2> LinearSpringOf<double>::numbers = [] {
  Number k = plain_number<&LinearSpring::stiffness>("stiffness", {}, Range::not_negative);
  k.effort_power = 1;
  k.measure_power = -1;
  k.needed = Number::Needed::always;
  Number g0 = plain_number<&LinearSpring::free_length>("free_length", {});
  g0.angle_key = "free_angle";
  g0.measure_power = 1;
  g0.range_of_measure = true;
  g0.needed = Number::Needed::as_length;
  return std::array{k, g0};
}();

}  // namespace poise
