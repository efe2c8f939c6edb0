#pragma once

#include <array>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Motor whose effort falls evenly with its rate, as that of a DC motor at a constant voltage: it drives its measure
/// with  M(w) = M0 (1 - w/w0),  w = dg/dt, so that T = -M. With voltage U, constant K and resistance R:
/// M0 = K U/R, w0 = U/K.
template <class N>
struct DcMotorOf {
  N stall = N(0);    ///< M0, at rest: N or N m
  N no_load = N(1);  ///< w0, at which it has no effort: m/s or rad/s

  template <class P>
  DcMotorOf<P> with(const P* p) const {
    return {p[0], p[1]};
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& w) const {
    const S slope = S(stall) / S(no_load);
    return {slope * w - S(stall), S(0), slope};
  }

  template <class S>
  S force_by(int number, const S&, const S& w) const {
    if (number == 0) return w / S(no_load) - S(1);
    return -S(stall) * w / (S(no_load) * S(no_load));
  }

  std::string_view idle() const { return stall == 0.0 ? "its effort at rest is zero" : ""; }

  bool damps_small_motion() const { return false; }
  static constexpr int affine_numbers = 1;
  static constexpr std::string_view left_out = "motors are off in statics";
  static constexpr std::array tables{LawTable{"motor", true}};
  static const std::array<Number, 2> numbers;
};

using DcMotor = DcMotorOf<double>;

template <>
inline constexpr std::array<Number, 2> DcMotorOf<double>::numbers = [] {
  Number rest = plain_number<&DcMotor::stall>("stall_force", {}, Range::not_negative);
  rest.angle_key = "stall_torque";
  rest.effort_power = 1;
  rest.needed = Number::Needed::always;
  Number free = plain_number<&DcMotor::no_load>("no_load_rate", dimension::time.power(-1), Range::positive);
  free.measure_power = 1;
  free.needed = Number::Needed::always;
  return std::array{rest, free};
}();

}  // namespace poise
