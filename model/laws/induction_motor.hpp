#pragma once

#include <array>
#include <string_view>

#include "model/laws/law_force.hpp"
#include "model/number.hpp"

namespace poise {

/// Induction motor by Kloss's formula: at the slip s = 1 - w/ws, w = dg/dt, it drives its measure with
///   M = 2 Mk / (s/sk + sk/s) = 2 Mk sk s / (s^2 + sk^2),  T = -M,
/// which is largest, Mk, at the breakdown slip sk, zero at the synchronous rate ws, and brakes beyond it.
/// Source: M. Kloss, Drehmoment und Schluepfung des Drehstrommotors, Archiv fuer Elektrotechnik 5, 1917.
template <class N>
struct InductionMotorOf {
  N breakdown = N(0);    ///< Mk: N or N m
  N slip = N(1);         ///< sk
  N synchronous = N(1);  ///< ws: m/s or rad/s

  template <class P>
  InductionMotorOf<P> with(const P* p) const {
    return {p[0], p[1], p[2]};
  }

  template <class S>
  LawForce<S> resisting(const S&, const S& w) const {
    const S s = S(1) - w / S(synchronous);
    return {-S(breakdown) * share(s), S(0), S(breakdown) * share_by(s) / S(synchronous)};
  }

  template <class S>
  S force_by(int number, const S&, const S& w) const {
    const S s = S(1) - w / S(synchronous), k = S(slip), squares = s * s + k * k;
    if (number == 0) return -share(s);
    if (number == 1) return -S(2) * S(breakdown) * s * (s * s - k * k) / (squares * squares);
    return -S(breakdown) * share_by(s) * w / (S(synchronous) * S(synchronous));
  }

  std::string_view idle() const { return breakdown == 0.0 ? "its breakdown effort is zero" : ""; }

  bool damps_small_motion() const { return false; }
  static constexpr int affine_numbers = 1;
  static constexpr std::string_view left_out = "motors are off in statics";
  static constexpr std::array tables{LawTable{"motor", true, "synchronous_rate"}};
  static const std::array<Number, 3> numbers;

 private:
  // M/Mk, and its derivative by s.
  template <class S>
  S share(const S& s) const {
    const S k = S(slip);
    return S(2) * k * s / (s * s + k * k);
  }
  template <class S>
  S share_by(const S& s) const {
    const S k = S(slip), squares = s * s + k * k;
    return S(2) * k * (k * k - s * s) / (squares * squares);
  }
};

using InductionMotor = InductionMotorOf<double>;

template <>
inline constexpr std::array<Number, 3> InductionMotorOf<double>::numbers = [] {
  Number most = plain_number<&InductionMotor::breakdown>("breakdown_force", {}, Range::not_negative);
  most.angle_key = "breakdown_torque";
  most.effort_power = 1;
  most.needed = Number::Needed::always;
  Number part = plain_number<&InductionMotor::slip>("breakdown_slip", {}, Range::positive);
  part.needed = Number::Needed::always;
  Number rate =
      plain_number<&InductionMotor::synchronous>("synchronous_rate", dimension::time.power(-1), Range::positive);
  rate.measure_power = 1;
  rate.needed = Number::Needed::always;
  return std::array{most, part, rate};
}();

}  // namespace poise
