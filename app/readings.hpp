#pragma once

#include <vector>

#include "app/quantity.hpp"
#include "statics/static_model.hpp"

namespace poise::app {

/// What a spring shows: length, m, and force, N, tension positive.
struct SpringReading {
  double length = 0.0;
  double force = 0.0;
  bool slack = false;
};

/// Everything that can be read off a mechanism standing still; all SI, one entry per item of the scene.
struct Readings {
  std::vector<BodyPose<double>> poses;  ///< bodies
  std::vector<double> travel;           ///< joints: signed distance from a to b along the axis; 0 without travel
  std::vector<SpringReading> springs;
  std::vector<double> torsion_moments;  ///< torsion springs: N m on the second body, -k (angle(b) - angle(a) - free)
  std::vector<double> stops;            ///< value that the stop limits, rad or m
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

/// What a stop limits: an angle or a length.
Quantity quantity_of(const Stop& stop);

}  // namespace poise::app
