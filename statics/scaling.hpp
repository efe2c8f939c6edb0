#pragma once

#include "model/scales.hpp"
#include "model/scene.hpp"

namespace poise {

/// Scales of a scene whose reach (Layout::size) is `size`, m.
Scales choose_scales(const Scene& scene, double size);

/// The same mechanism measured in `scales`: lengths / length, forces / force, stiffness * length / force, torques and
/// torsional stiffness / energy; masses and gravity so that weights come out in force and time stays in seconds.
/// Angles are untouched.
Scene scaled(const Scene& scene, const Scales& scales);

}  // namespace poise
