#pragma once

#include <vector>

#include "app/results/parts.hpp"
#include "statics/model/cam_contact.hpp"

namespace poise::app {

/// The contact of every cam: cams {name: {pressure_angle, normal_force, side_thrust}}, null where it has none. Nothing
/// where there are no cams. `radii`: to which the contacts are known (ValueRadii::cams).
void add_cams(Group& group, const ScaledModel& model, const std::vector<CamReading>& cams,
              const std::vector<CamContact>& radii = {});

}  // namespace poise::app
