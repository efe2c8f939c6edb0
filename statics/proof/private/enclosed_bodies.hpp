#pragma once

#include <vector>

#include "statics/bodies/ball_scalar.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// The places of all bodies, SI, from the anchor of the layout, at the equilibrium that a confirmed certificate
/// encloses.
std::vector<PlacedBody<Ball>> enclosed_bodies(const StaticModel& model, const Certificate& certificate);

}  // namespace poise
