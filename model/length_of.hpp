#pragma once

#include "model/plain_value.hpp"
#include "model/planar.hpp"

namespace poise {

/// The length |a| of a vector; of a zero vector in dual numbers, where it has no derivative, zero without one.
template <class T>
T length_of(const Planar<T>& a) {
  if constexpr (has_derivatives<T>) {
    if (is_zero(a.x) && is_zero(a.y)) return T(0);
  }
  return norm(a);
}

}  // namespace poise
