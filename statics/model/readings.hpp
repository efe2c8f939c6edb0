#pragma once

#include <limits>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise {

/// State of a force element: the value of its measure, rad or m, and its force without motion, N m or N, positive where
/// it tends to diminish the measure: tension of a spring, the opposite of the moment on the second body.
struct ElementReading {
  double value = 0.0;
  double force = 0.0;
  double radius = std::numeric_limits<double>::infinity();  ///< proved distance of `force` from the exact one
  bool slack = false;
};

/// What follows from the pose of a mechanism that stands still; all SI, one entry per item of the scene.
struct Readings {
  std::vector<BodyPose<double>> poses;  ///< bodies
  std::vector<double> travel;           ///< joints: signed distance from a to b along the axis; 0 without travel
  std::vector<ElementReading> elements;
  std::vector<double> stops;  ///< value that the stop limits, rad or m
};

/// Of a scene whose bodies are at `poses`, SI; of more poses than bodies only the first count.
Readings readings_of(const Scene& scene, std::vector<BodyPose<double>> poses);

/// Of a model at the scaled coordinates x.
Readings read_off(const StaticModel& model, const std::vector<double>& x);

/// World coordinates of a point, m.
Vec2 world(const Scene& scene, const Readings& readings, PointRef point);

/// The limit at which a stop is active.
struct PressedLimit {
  const char* name = "";  ///< "min" or "max"
  double value = 0.0;     ///< rad or m
};

/// The limit of a stop that is nearest to its value, rad or m.
PressedLimit pressed_limit(const Stop& stop, double value);

}  // namespace poise
