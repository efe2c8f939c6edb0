#pragma once

// Balls of numbers known in 50 digits.

#include "solvers/ball.hpp"
#include "solvers/real50.hpp"

namespace poise::solvers {

/// A ball that contains the number that x is the 50-digit rounding of.
inline Ball enclosing(const Real50& x) {
  const Ball::Precision precision(400);
  const Ball::InputRounding exact(false);
  Ball out;
  Real50 rest = x;
  for (int k = 0; k < 5 && rest != 0; ++k) {
    const double part = static_cast<double>(rest);
    out += Ball(part);
    rest -= part;
  }
  return out.widened(1e-47 * static_cast<double>(abs(x)));
}

/// Whether the number that x is the 50-digit rounding of is in the ball.
inline bool encloses(const Ball& ball, const Real50& x) {
  const Ball::Precision precision(400);
  return (ball - enclosing(x)).contains_zero();
}

}  // namespace poise::solvers
