#pragma once

#include <vector>

#include "app/quantity.hpp"
#include "statics/static_model.hpp"

namespace poise::app {

/// What a force element shows: the value of its measure, rad or m, and the force at rest, N m or N, positive where it
/// tends to diminish the measure: tension of a spring, the opposite of the moment on the second body.
struct ElementReading {
  double value = 0.0;
  double force = 0.0;
  bool slack = false;
};

/// Everything that can be read off a mechanism standing still; all SI, one entry per item of the scene.
struct Readings {
  std::vector<BodyPose<double>> poses;  ///< bodies
  std::vector<double> travel;           ///< joints: signed distance from a to b along the axis; 0 without travel
  std::vector<ElementReading> elements;
  std::vector<double> stops;  ///< value that the stop limits, rad or m
};

/// Reads a scene whose bodies stand at the scaled coordinates x.
Readings read_off(const StaticModel& model, const std::vector<double>& x);

/// World coordinates of a point, m.
Vec2 world(const Scene& scene, const Readings& readings, PointRef point);

/// The limit that a pressed stop leans on.
struct PressedLimit {
  const char* name = "";  ///< "min" or "max"
  double value = 0.0;     ///< rad or m
};

/// The limit next to the value of a stop.
PressedLimit pressed_limit(const Stop& stop, double value);

}  // namespace poise::app
