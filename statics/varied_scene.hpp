#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/dimension.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "statics/static_model.hpp"

namespace poise {

/// A scene of which one number varies over a range:
///   a path as for set_value()    "load.P", "spring.k.stiffness", "point.crank.B.x"
///   "loads"                      a factor of all loads (forces and torques)
///   "angle.BODY", "travel.JOINT", "drive.NAME"   a driven measure: it is held at the value, by the force sought
class VariedScene {
 public:
  /// `from` and `to` in the scene's own units. Throws InputError for a name that does not exist (with the nearest), a
  /// range of length zero, or values that the number cannot have.
  VariedScene(Scene scene, const std::string& name, double from, double to);
  /// All numbers in which two scenes of one structure differ, together: at the part s, 0 <= s <= 1, each is
  /// (1 - s) a + s b, of a force its vector. Guesses and drives, on which equilibrium does not depend, are those of
  /// `to`. Throws InputError where the scenes differ in more than numbers, in a limit of a stop that only one of them
  /// has, or in no number.
  VariedScene(Scene from, Scene to);
  /// The same number over the same range in another scene, which differs from this one in other numbers only; compiled
  /// in the coordinates and units of `like`, so that points of both can be compared.
  VariedScene in(Scene scene, const VariedScene& like) const;

  /// The scene as given.
  const Scene& scene() const { return scene_; }
  const std::string& name() const { return name_; }
  double from() const { return from_; }  ///< SI
  double to() const { return to_; }      ///< SI
  /// SI value at a part of the range, exactly its ends at 0 and 1; and the part at a value.
  double value_at(double part) const { return part == 1.0 ? to_ : from_ + part * (to_ - from_); }
  double part_at(double value) const { return (value - from_) / (to_ - from_); }
  /// SI value of one unit of the number in the scene's own units, and the name of that unit.
  double unit() const { return unit_; }
  std::string unit_name() const;
  /// The number is a driven measure, held by Scene::stops.back() of scene_at(), with min = max.
  bool is_driven() const { return driven_; }
  /// Dimension of the force that holds a driven measure: a torque, N m, or a force, N.
  Dimension effort_dimension() const;
  /// The number enters forces, tangent and constraints affinely, so that two values determine all others.
  bool is_affine() const { return affine_; }
  /// A value within the range at which nothing vanishes that does not vanish elsewhere.
  double generic() const { return from_ + 0.6180339887498949 * (to_ - from_); }
  /// A scene with the structure that all values share.
  Scene generic_scene() const { return structure_ ? *structure_ : scene_at(generic()); }
  const Scales& scales() const { return scales_; }
  /// Of varied loads: how many times the forces that act where they are zero; 0 where no others act.
  double excess() const;

  /// The scene at a value, SI.
  Scene scene_at(double value) const;
  /// Compiled for statics; coordinates and scales are the same for all values.
  std::unique_ptr<StaticModel> model_at(double value) const;

 private:
  Scene scene_;
  std::string name_;
  Dimension dimension_{};
  double from_ = 0.0, to_ = 0.0, unit_ = 1.0;
  bool driven_ = false, affine_ = false;
  std::vector<ParameterPlace> places_;
  std::vector<double> whole_;           // values of the places that the factor 1 stands for
  std::shared_ptr<const Scene> other_;  // at the part 1, where all differing numbers vary together
  Scales scales_{};
  std::shared_ptr<const Scene> structure_;  // of in()
};

}  // namespace poise
