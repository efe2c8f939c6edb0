#pragma once

#include "statics/inverse/conditioned_equilibrium.hpp"
#include "statics/quantities/quantity_value.hpp"

namespace poise {

/// All left sides at (z, p), behind each other.
template <class T>
void ConditionedEquilibrium::evaluate(const T* p, const T* z, std::vector<T>& out) const {
  out.assign(static_cast<std::size_t>(size()), T(0));
  std::vector<NumberedEquations::Placed<T>> placed;
  equations_.residual(p, z, out.data(), placed);
  QuantityPlace<T> place(equations_, p, z, acting_.driven);
  std::size_t k = static_cast<std::size_t>(equations_.unknowns());
  for (const Condition& one : conditions_) out[k++] = place.value(one.of) - T(one.value);
}

}  // namespace poise
