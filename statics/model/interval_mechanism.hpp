#pragma once

#include <numbers>

#include "model/mechanism_impl.hpp"
#include "solvers/interval.hpp"

namespace poise {

using solvers::Interval;

// Sine and cosine together.
template <>
inline Planar<Interval> unit(const Interval& angle) {
  Planar<Interval> out;
  solvers::sin_cos(angle, out.y, out.x);
  return out;
}

// Half of the enclosed full turn: halving is exact.
template <>
inline Interval pi_of() {
  return Interval::from(0.5 * solvers::full_turn.minus_lower(), 0.5 * solvers::full_turn.upper());
}

/// The angle of a vector, counter-clockwise from the x axis, in [0, 2 pi); all numbers where it may be zero, from which
/// the angle leaps.
template <>
inline Interval full_angle_of(const Planar<Interval>& a) {
  if (!(a.y > 0) && !(a.y < 0) && !(a.x < 0)) return Interval::entire();
  return solvers::angle_of(a.x, a.y, std::numbers::pi);
}

}  // namespace poise
