#pragma once

#include "model/measures/linear.hpp"

namespace poise {

/// angle(body_b) - angle(body_a), where angle = q_frame + turn.
template <class T>
LinearMeasure<T> compile_angle(const Layout& layout, const Phasors<T>& phasors, const Measure& measure) {
  const Link& a = layout.links[measure.body_a];
  const Link& b = layout.links[measure.body_b];
  LinearMeasure<T> g(phasors, a.turn, b.turn);
  if (a.frame == b.frame) return g;
  g.add(phasors, b.frame, T(1));
  g.add(phasors, a.frame, T(-1));
  return g;
}

}  // namespace poise
