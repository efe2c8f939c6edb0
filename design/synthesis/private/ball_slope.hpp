#pragma once

#include "solvers/ball.hpp"

namespace poise::synthesis {

/// A function of one variable at a place: its value, and its derivative there, both balls.
struct BallSlope {
  solvers::Ball value, slope;

  BallSlope() = default;
  BallSlope(int number) : value(number) {}     // NOLINT(google-explicit-constructor)
  BallSlope(double number) : value(number) {}  // NOLINT(google-explicit-constructor)
  BallSlope(const solvers::Ball& v, const solvers::Ball& s) : value(v), slope(s) {}

  friend BallSlope operator+(const BallSlope& a, const BallSlope& b) { return {a.value + b.value, a.slope + b.slope}; }
  friend BallSlope operator-(const BallSlope& a, const BallSlope& b) { return {a.value - b.value, a.slope - b.slope}; }
  friend BallSlope operator-(const BallSlope& a) { return {-a.value, -a.slope}; }
  friend BallSlope operator*(const BallSlope& a, const BallSlope& b) {
    return {a.value * b.value, a.slope * b.value + a.value * b.slope};
  }
  friend BallSlope operator/(const BallSlope& a, const BallSlope& b) {
    const solvers::Ball ratio = a.value / b.value;
    return {ratio, (a.slope - ratio * b.slope) / b.value};
  }
  friend bool operator<(const BallSlope& a, const BallSlope& b) { return a.value < b.value; }
  friend bool operator>(const BallSlope& a, const BallSlope& b) { return a.value > b.value; }

  friend BallSlope sqrt(const BallSlope& a) {
    const solvers::Ball root = sqrt(a.value);
    return {root, a.slope / (root + root)};
  }
  friend BallSlope exp(const BallSlope& a) {
    const solvers::Ball power = exp(a.value);
    return {power, power * a.slope};
  }
  friend BallSlope log(const BallSlope& a) { return {log(a.value), a.slope / a.value}; }
  friend BallSlope sin(const BallSlope& a) { return {sin(a.value), cos(a.value) * a.slope}; }
  friend BallSlope cos(const BallSlope& a) { return {cos(a.value), -sin(a.value) * a.slope}; }
  friend BallSlope atan2(const BallSlope& y, const BallSlope& x) {
    return {atan2(y.value, x.value), (x.value * y.slope - y.value * x.slope) / (x.value * x.value + y.value * y.value)};
  }
  /// Where the number may be zero the slope is anything.
  friend BallSlope abs(const BallSlope& a) {
    if (a.value.contains_zero()) return {abs(a.value), solvers::Ball::entire()};
    return a.value > solvers::Ball(0) ? a : -a;
  }
};

}  // namespace poise::synthesis
