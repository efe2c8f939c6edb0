#pragma once

#include <array>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Constant force: T = F for every value of the measure, V = F g. A counterweight on a rope, a constant-force spring.
template <class N>
struct ConstantForceOf {
  N force = N(0);  ///< F: N or N m, positive if it tends to reduce g

  template <class P>
  ConstantForceOf<P> with(const P* p) const {
    return {p[0]};
  }

  template <class S>
  S energy(const S& g) const {
    return S(force) * g;
  }

  template <class S>
  LawForce<S> at_rest(const S&) const {
    return {S(force), S(0), S(0)};
  }

  template <class S>
  S force_by(int, const S&, const S&) const {
    return S(1);
  }

  double force_scale(double) const { return force < 0.0 ? -force : force; }

  std::string_view idle() const { return force == 0.0 ? "it is zero" : ""; }

  static constexpr std::array in_motion{&ConstantForceOf::force};  ///< see with_more()
  static constexpr std::array tables{LawTable{"constant_force"}};
  static const std::array<Number, 1> numbers;
};

using ConstantForce = ConstantForceOf<double>;

template <>
inline constexpr std::array<Number, 1> ConstantForceOf<double>::numbers = [] {
  Number F = plain_number<&ConstantForce::force>("force", {});
  F.angle_key = "torque";
  F.effort_power = 1;
  F.needed = Number::Needed::always;
  return std::array{F};
}();

}  // namespace poise
