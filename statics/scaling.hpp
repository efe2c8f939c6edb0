#pragma once

#include "model/scene.hpp"

namespace poise {

/// Units in which a mechanism's numbers are of order one. Powers of two, so that scaling rounds nothing.
struct Scales {
  double length = 1.0;  ///< m: about the reach of the mechanism
  double force = 1.0;   ///< N: about the sum of all loads, or, without loads, the largest spring force

  double energy() const { return length * force; }
};

/// Scales of a scene whose reach (Layout::size) is `size`, m.
Scales choose_scales(const Scene& scene, double size);

/// The same mechanism measured in `scales`: lengths / length, forces / force, stiffness * length / force, torques and
/// torsional stiffness / energy; masses and gravity so that weights come out in force and time stays in seconds.
/// Angles are untouched.
Scene scaled(const Scene& scene, const Scales& scales);

}  // namespace poise
