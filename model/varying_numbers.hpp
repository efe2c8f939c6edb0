#pragma once

// Which numbers of a scene vary, so that its compiled mechanism has to keep a place for them.

#include <span>
#include <vector>

#include "model/parameters.hpp"

namespace poise {

/// Numbers of a scene that are to have other values than those that it holds: some rows of the parameter table, and all
/// that follows from them along expressions and from sections of flexible links. A layout keeps what depends on them
/// apart, and as if it were not zero (lay_out()). None by default.
class VaryingNumbers {
 public:
  VaryingNumbers() = default;
  VaryingNumbers(const Scene& scene, std::span<const ParameterPlace> rows);

  bool empty() const { return places_.empty(); }
  bool has(const ParameterPlace& place) const;
  /// Some number of an item, of a point with its index in the body.
  bool has_any(Owner owner, int item, int part = 0) const;
  /// Some number of an owner of this kind.
  bool has_some(Owner owner) const;

  bool has_gravity() const { return has_any(Owner::scene, 0); }
  bool has_mass(int body) const { return has({Owner::body, body, 0, 0}); }
  bool has_inertia(int body) const { return has({Owner::body, body, 0, 1}); }
  bool has_center(int body) const { return has({Owner::body, body, 0, 2}) || has({Owner::body, body, 0, 3}); }
  bool has_point(PointRef point) const { return has_any(Owner::point, point.body, point.point); }
  /// The constant angle, or the length, that a joint keeps: its first number, which others than such joints have for
  /// their friction.
  bool has_angle(const Scene& scene, int joint) const;
  bool has_length(const Scene& scene, int joint) const;
  /// The direction of a joint's line, which expressions alone can vary.
  bool has_axis(int joint) const;
  /// Where the end of the carriage of a slide with friction is in its second body.
  bool has_carriage(const Scene& scene, int joint) const;
  /// Some number of the friction of a joint.
  bool has_friction(const Scene& scene, int joint) const;

 private:
  void add_followers(const Scene& scene);

  std::vector<ParameterPlace> places_;  // sorted by owner, item, part and number
  std::vector<int> axes_;               // joints, sorted
};

}  // namespace poise
