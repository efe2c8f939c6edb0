#pragma once

// Measures of bodies whose places are balls (statics/body_forces.hpp). Private to statics/.

#include "solvers/ball.hpp"
#include "statics/body_forces.hpp"

namespace poise {

template <>
solvers::Ball body_forces::length_of(const Planar<solvers::Ball>& d);

template <>
Planar<solvers::Ball> body_forces::in_any_direction();

}  // namespace poise
