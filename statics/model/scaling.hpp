#pragma once

#include "model/scales.hpp"
#include "model/scene.hpp"

namespace poise {

/// Scales of a scene of size (Layout::size) `size`, m.
Scales choose_scales(const Scene& scene, double size);

}  // namespace poise
