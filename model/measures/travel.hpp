#pragma once

#include "model/measures/linear.hpp"

namespace poise {

/// The length coordinate of a slide or pin in a slot.
template <class T>
LinearMeasure<T> compile_travel(const Layout& layout, const Phasors<T>& phasors, const Measure& measure) {
  LinearMeasure<T> g;
  g.add(phasors, layout.travel[measure.joint], T(1));
  return g;
}

}  // namespace poise
