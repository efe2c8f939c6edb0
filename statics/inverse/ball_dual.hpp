#pragma once

#include <ceres/jet.h>

#include "model/plain_value.hpp"
#include "model/set_valued.hpp"
#include "statics/bodies/ball_scalar.hpp"

namespace poise {

/// Enclosures of numbers with those of their derivatives by some variables. Where pieces of a law or a measure meet in
/// them comparisons are not decided (Ball::Undecided).
using BallDual = ceres::Jet<Ball, 4>;

/// The middle, which chooses pivots.
template <>
inline double plain_value(const BallDual& x) {
  return x.a.middle();
}

template <>
inline BallDual hull(const BallDual& a, const BallDual& b) {
  BallDual out(Ball::of_both(a.a, b.a));
  for (int k = 0; k < BallDual::DIMENSION; ++k) out.v[k] = Ball::of_both(a.v[k], b.v[k]);
  return out;
}

template <>
inline BallDual middle_of(const BallDual& a) {
  return BallDual(a.a.midpoint());
}

template <>
inline BallDual pi_of() {
  return BallDual(Ball::pi());
}

template <>
inline BallDual full_angle_of(const Planar<BallDual>& a) {
  BallDual out = atan2(a.y, a.x);
  out.a = full_angle_of(Planar<Ball>{a.x.a, a.y.a});
  return out;
}

}  // namespace poise
