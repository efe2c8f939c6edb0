#pragma once

#include <vector>

#include "statics/model/cam_contact.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"

namespace poise {

/// Proved distances of numbers of the pose Certificate::x, in double, from those of the equilibrium; 0 where
/// nothing is proved.
struct ValueRadii {
  double energy = 0.0;        ///< N m
  std::vector<double> stops;  ///< of the measure of each stop, rad or m
  /// The radii of the numbers of each contact of cam_readings(); infinite where nothing is proved.
  std::vector<CamContact> cams;
};

/// Encloses the energy, the measures of the stops and the contacts of cams in all that a confirmed certificate leaves
/// open, in ball arithmetic. `reactions`: those of Certificate::x, enclosed by enclose_reactions().
ValueRadii enclose_values(const StaticModel& model, const Certificate& certificate,
                          const std::vector<Reaction>& reactions);

}  // namespace poise
