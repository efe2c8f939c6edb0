#pragma once

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

}  // namespace poise
