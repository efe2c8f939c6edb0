#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "model/parameters.hpp"
#include "motion/reduced_motion.hpp"

namespace poise {

/// A parameter of a scene that the equations of motion depend on without changing its geometry: these can be
/// identified. These are the numbers of bodies, force elements and loads; see set_value() for paths.
class SceneParameter {
 public:
  /// Empty where the scene has no such parameter, or it belongs to something else.
  static std::optional<SceneParameter> find(const Scene& scene, std::string_view path);

  const std::string& path() const { return path_; }
  const ParameterPlace& place() const { return place_; }
  const Dimension& dimension() const { return dimension_; }
  /// SI value. set() checks no range: a lumped mass beside others may be negative.
  double get(const Scene& scene) const { return value_at(scene, place_).value_or(0.0); }
  /// A force of magnitude zero has no direction and is left unchanged.
  void set(Scene& scene, double si) const;
  /// How the scaled scene's equations of motion change per SI unit of the number; `scene` in SI.
  Influence influence(const Scene& scene, const Scales& scales) const;
  /// d(force of the element)/d(number), SI, at the measure g and its rate w; 0 where it belongs to something else.
  double force_by(const Scene& scene, int element, double g, double w) const;

  /// True for masses, inertias, stiffnesses, damping and loads: multiplying all of these by one factor changes no
  /// motion.
  bool scales_with_force() const { return dimension_.force + dimension_.mass != 0; }
  /// Number of a body's inertia.
  bool is_inertial() const { return place_.owner == Owner::body; }

 private:
  SceneParameter(const ParameterRow& row) : place_(row.place), dimension_(row.dimension), path_(row.path.text()) {}

  ParameterPlace place_;
  Dimension dimension_;
  std::string path_;
};

}  // namespace poise
