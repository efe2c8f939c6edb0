#pragma once

// What the templates of model/ need of a scalar, for balls.

#include "model/layout.hpp"
#include "model/phasors.hpp"
#include "model/planar.hpp"
#include "solvers/ball.hpp"

namespace poise {

using solvers::Ball;

// Sine and cosine together.
template <>
inline Planar<Ball> unit(const Ball& angle) {
  Planar<Ball> out;
  sin_cos(angle, out.y, out.x);
  return out;
}

template <>
inline Ball pi_of() {
  return Ball::pi();
}

// All numbers where it may be zero, from which the angle leaps.
template <>
inline Ball full_angle_of(const Planar<Ball>& a) {
  if (!(a.y > 0) && !(a.y < 0) && !(a.x < 0)) return Ball::entire();
  const Ball half = angle_of(-a.x, -a.y);
  return half + Ball::pi();
}

template <>
inline Ball rounded_number(double value, double rounding) {
  return Ball::rounded(value, rounding);
}

template <>
inline Ball uncertain_number(const Ball& value, double by) {
  return value.widened(by);
}

}  // namespace poise
