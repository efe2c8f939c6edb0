#include "statics/bodies/ball_measures.hpp"

namespace poise {

template <>
Ball body_forces::length_of(const Planar<Ball>& d) {
  return hypot(d.x, d.y);
}

template <>
Planar<Ball> body_forces::in_any_direction() {
  return {Ball(0).widened(1.0), Ball(0).widened(1.0)};
}

}  // namespace poise
