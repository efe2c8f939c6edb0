#pragma once

#include <vector>

#include "model/mechanism_impl.hpp"
#include "solvers/ball.hpp"
#include "statics/static_model.hpp"

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

/// A scene compiled in ball arithmetic: once with its doubles as exact numbers, and once with each as all the numbers
/// that round to it; and in double.
struct BallMechanism {
  explicit BallMechanism(const StaticModel& model) : BallMechanism(model, model.layout()) {}
  /// With a layout that was loosened.
  BallMechanism(const StaticModel& model, const Layout& layout);

  Mechanism<Ball> exact;
  Mechanism<Ball> rounded;
  Mechanism<double> plain;
  std::vector<double> row_rounding;  ///< of all constraint rows (statics/closure_rounding.hpp)

  const Mechanism<Ball>& of(bool rounding) const { return rounding ? rounded : exact; }
};

}  // namespace poise
