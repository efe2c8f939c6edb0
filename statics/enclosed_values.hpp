#pragma once

#include <vector>

#include "statics/certificate.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// Proved distances of numbers of the pose Certificate::x, in double, from those of the equilibrium; 0 where
/// nothing is proved.
struct ValueRadii {
  double energy = 0.0;        ///< N m
  std::vector<double> stops;  ///< of the measure of each stop, rad or m
};

/// Encloses the energy and the measures of the stops in all that a confirmed certificate leaves open, in ball
/// arithmetic.
ValueRadii enclose_values(const StaticModel& model, const Certificate& certificate);

}  // namespace poise
