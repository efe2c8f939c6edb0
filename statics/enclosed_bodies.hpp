#pragma once

#include <vector>

#include "statics/ball_scalar.hpp"
#include "statics/body_measures.hpp"
#include "statics/certificate.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// The places of all bodies, SI, from the anchor of the layout, at the equilibrium that a confirmed certificate
/// encloses.
std::vector<PlacedBody<Ball>> enclosed_bodies(const StaticModel& model, const Certificate& certificate);

}  // namespace poise
