#pragma once

// Measures of bodies whose places are balls (statics/bodies/body_forces.hpp).

#include "statics/bodies/ball_scalar.hpp"
#include "statics/bodies/body_forces.hpp"

namespace poise {

template <>
Ball body_forces::length_of(const Planar<Ball>& d);

template <>
Planar<Ball> body_forces::in_any_direction();

}  // namespace poise
