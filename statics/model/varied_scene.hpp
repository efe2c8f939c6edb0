#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "model/dimension.hpp"
#include "model/parameters.hpp"
#include "model/scene.hpp"
#include "model/varying_numbers.hpp"
#include "statics/model/static_model.hpp"

namespace poise {

/// A scene of which one number varies over a range:
///   a path as for set_value()    "load.P", "spring.k.stiffness", "point.crank.B.x"
///   "loads"                      a factor of all loads (forces and torques)
///   "angle.BODY", "length.ELEMENT", ...   a driven measure, any of find_measure(), or "drive.NAME", that of a drive of
///                                         the scene: it is held at the value, by the force sought
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
  /// in the units of `like`, so that points of both can be compared.
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
  /// What that is: "angle of upper in the world".
  const std::string& driven_words() const { return driven_words_; }
  /// Dimension of the force that holds a driven measure: a torque, N m, or a force, N.
  Dimension effort_dimension() const;
  /// The number enters forces, tangent and constraints affinely, so that two values determine all others.
  bool is_affine() const { return affine_; }
  /// A value within the range at which nothing vanishes that does not vanish elsewhere.
  double generic() const { return from_ + 0.6180339887498949 * (to_ - from_); }
  const Scales& scales() const { return scales_; }
  /// Of varied loads: how many times the forces that act where they are zero; 0 where no others act.
  double excess() const;

  /// A row of the parameter table that varies in proportion to the part of the range, SI. Of a force the magnitude
  /// along the direction that it has in reference_scene(), negative where it is reversed.
  struct Course {
    ParameterPlace place;
    double from = 0.0, to = 0.0;

    double at(double part) const { return part == 1.0 ? to : from + part * (to - from); }
  };
  /// A force that varies with its direction.
  struct VectorCourse {
    int force = 0;
    Vec2 from{}, to{};
  };
  /// These are the courses for all values. What follows from their numbers varies too, and is set from named ones
  /// before the others are.
  const std::vector<Course>& courses() const { return courses_; }
  const std::vector<VectorCourse>& vector_courses() const { return vector_courses_; }
  /// A scene in which all else is as at every value; what follows from named numbers is as their expressions say.
  Scene reference_scene() const;
  /// Rows of the numbers that vary, and those for which the structure leaves room.
  std::vector<ParameterPlace> varying_rows() const;
  const VaryingNumbers& varying() const { return varying_; }
  /// Leaves room for the numbers of another varied scene of the same structure, so that both have the same coordinates
  /// where one is in() the other.
  void vary_with(const VariedScene& other);

  /// The scene at a value, SI.
  Scene scene_at(double value) const;
  /// Compiled for statics; coordinates and scales are the same for all values.
  std::unique_ptr<StaticModel> model_at(double value) const;

 private:
  void find_courses();

  Scene scene_;
  std::string name_, driven_words_;
  Dimension dimension_{};
  double from_ = 0.0, to_ = 0.0, unit_ = 1.0;
  bool driven_ = false, affine_ = false;
  std::vector<ParameterPlace> places_;
  std::vector<double> whole_;           // values of the places that the factor 1 stands for
  std::shared_ptr<const Scene> other_;  // at the part 1, where all differing numbers vary together
  Scales scales_{};
  std::vector<Course> courses_;
  std::vector<VectorCourse> vector_courses_;
  std::vector<ParameterPlace> others_;  // of vary_with()
  VaryingNumbers varying_;
};

}  // namespace poise
