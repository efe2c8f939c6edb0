#pragma once

#include <string>
#include <vector>

#include "exchange/dxf.hpp"

namespace poise::app {

/// The positions of a scene that a result of poise path with --json has: those of --at, or where it has none all points
/// of its curves. Throws InputError where it is none of this scene.
std::vector<NamedPosition> positions_of_path(const std::string& file, const Scene& scene);

}  // namespace poise::app
