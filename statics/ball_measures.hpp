#pragma once

// Measures of bodies whose places are balls (statics/body_measures_impl.hpp): defined in enclosed_reactions.cpp.
// Private to statics/.

#include "solvers/ball.hpp"
#include "statics/body_measures_impl.hpp"

namespace poise {

template <>
solvers::Ball body_measures::length_of(const Planar<solvers::Ball>& d);

template <>
Planar<solvers::Ball> body_measures::in_any_direction();

}  // namespace poise
