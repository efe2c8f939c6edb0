#pragma once

// Measures of bodies whose places are balls (statics/body_forces.hpp). Private to statics/.

#include "statics/ball_scalar.hpp"
#include "statics/body_forces.hpp"

namespace poise {

template <>
Ball body_forces::length_of(const Planar<Ball>& d);

template <>
Planar<Ball> body_forces::in_any_direction();

}  // namespace poise
