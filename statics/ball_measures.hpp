#pragma once

// Measures of bodies whose places are balls (statics/body_forces.hpp): defined in enclosed_reactions.cpp.
// Private to statics/.

#include <vector>

#include "solvers/ball.hpp"
#include "statics/body_forces.hpp"
#include "statics/certificate.hpp"
#include "statics/static_model.hpp"

namespace poise {

template <>
solvers::Ball body_forces::length_of(const Planar<solvers::Ball>& d);

template <>
Planar<solvers::Ball> body_forces::in_any_direction();

/// The places of all bodies, SI, from the anchor of the layout, at the equilibrium that a confirmed certificate
/// encloses.
std::vector<PlacedBody<solvers::Ball>> enclosed_bodies(const StaticModel& model, const Certificate& certificate);

}  // namespace poise
