#pragma once

#include <cstddef>
#include <variant>

#include "model/scene.hpp"

namespace poise {

/// Places of the numbers of GasStrut that give its limits.
inline constexpr int length_of_strut = 1, stroke_of_strut = 2;

/// Index of the gas strut whose rod a stop holds in its stroke, or -1. A stop with the name of a gas strut is the one
/// that reading a scene file adds for it: its limits are L - s and L (see GasStrut), so that it has no numbers of its
/// own.
inline int strut_of(const Scene& scene, const Stop& stop) {
  if (stop.table != "stop") return -1;
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    if (std::holds_alternative<GasStrut>(element.law) && element.name == stop.name) return static_cast<int>(e);
  }
  return -1;
}

/// Gives that stop the limits of its strut.
inline void hold_in_stroke(Stop& stop, const GasStrut& strut) {
  stop.min = strut.length - strut.stroke;
  stop.max = strut.length;
}

}  // namespace poise
