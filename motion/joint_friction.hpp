#pragma once

#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The names of joints with friction, each in quotes.
std::vector<std::string> joints_with_friction(const Scene& scene);

}  // namespace poise
