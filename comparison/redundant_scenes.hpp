#pragma once

#include <cstdint>

#include "model/scene.hpp"

namespace poise::comparison {

/// A random mechanism of one freedom with mass and gravity whose joints repeat each other in every position: a
/// parallelogram with a third crank, a table on two scissor lifts of one to three stages, or a four-bar one of whose
/// pins is written twice. It is assembled at its start.
Scene redundant_scene(std::uint64_t seed);

}  // namespace poise::comparison
