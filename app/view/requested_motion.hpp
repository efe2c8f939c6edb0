#pragma once

#include <nlohmann/json_fwd.hpp>

#include "model/scene_text.hpp"

namespace poise::app {

/// The motion of "mirror": [[x, y], [x, y]], two points of the line, then "turn", "about": [x, y], then
/// "move": [dx, dy], in the units of a scene whose angles have this unit, rad. What is left out does nothing. Throws
/// InputError.
PlaneMotion requested_motion(const nlohmann::json& request, double angle_unit);

}  // namespace poise::app
