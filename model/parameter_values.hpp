#pragma once

#include <optional>
#include <vector>

#include "model/scene.hpp"

namespace poise {

/// The values of the rows of parameter_table(), in its order, SI: each is value_at() its place, all found in one pass.
std::vector<std::optional<double>> parameter_values(const Scene& scene);

}  // namespace poise
