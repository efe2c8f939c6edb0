#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "model/scene.hpp"
#include "motion/reduced_motion.hpp"
#include "statics/scaling.hpp"

namespace poise {

/// A number of a scene that the equations of motion depend on without changing its geometry: what can be identified.
/// Paths as in set_value(): body.X.mass | inertia | center.x | center.y, spring.X.stiffness | free_length,
/// torsion_spring.X.stiffness | free_angle, damper.X.coefficient, torsion_damper.X.coefficient, friction.X.torque,
/// load.X.
class SceneNumber {
 public:
  /// Empty where the scene has no such number, or it is of another kind.
  static std::optional<SceneNumber> find(const Scene& scene, std::string_view path);

  const std::string& path() const { return path_; }
  /// SI value. set() asks for no range: a lump beside other masses may be negative.
  double get(const Scene& scene) const;
  void set(Scene& scene, double si) const;
  /// How the scaled scene's equations of motion change per SI unit of the number; `scene` in SI.
  Influence influence(const Scene& scene, const Scales& scales) const;

  /// True for masses, inertias, stiffnesses, damping and loads: multiplying all of these leaves a motion as it is.
  bool scales_with_force() const;
  /// The line spring whose stiffness or free length it is, or -1.
  int spring_stiffness() const { return kind_ == Kind::stiffness ? item_ : -1; }
  int spring_free_length() const { return kind_ == Kind::free_length ? item_ : -1; }
  /// Number of a body's inertia.
  bool is_inertial() const { return kind_ <= Kind::center_y; }

 private:
  enum class Kind {
    mass,
    inertia,
    center_x,
    center_y,
    stiffness,
    free_length,
    torsion_stiffness,
    free_angle,
    damping,
    torsion_damping,
    friction,
    force,
    torque
  };
  SceneNumber(Kind kind, int item, std::string path) : kind_(kind), item_(item), path_(std::move(path)) {}
  template <class AnyScene>
  static auto& number(Kind kind, int item, AnyScene& scene);

  Kind kind_;
  int item_;
  std::string path_;
};

}  // namespace poise
