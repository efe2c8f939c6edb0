#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "model/exact_sum.hpp"
#include "model/scene.hpp"
#include "model/varying_numbers.hpp"

namespace poise {

/// The purpose decides which parts of a scene enter its compiled model: statics needs no masses without weight,
/// dynamics needs all of them.
enum class Purpose { statics, dynamics };

/// The relative rounding of a number: half a unit in the last place.
inline constexpr double half_unit = 0x1p-53;

/// A number that is known to within `by` only, in scalars that can say so.
template <class T>
T uncertain_number(const T& value, double /*by*/) {
  return value;
}

/// A constant angle between bodies of one frame, rad.
struct Turn {
  ExactSum angle;
  /// By which it may be another because welds and slides set it in several ways that agree to rounding only.
  double open = 0.0;
  /// The joints whose angles vary among those that it is the sum of, each its index and 1, negative where the angle is
  /// subtracted; and the sum of the others.
  std::vector<int> varying{};
  ExactSum fixed{};

  template <class T>
  T to() const {
    return uncertain_number(angle.to<T>(), open);
  }
};

/// A vector that arms are made of, with numbers that vary: a point in its body's frame, a bar along the x axis of its
/// own, the direction of a joint's line, or the end of the carriage of a slide from its second point, in that point's
/// body.
struct VaryingVector {
  enum class Of { point, bar, axis, carriage };
  Of of = Of::point;
  PointRef point{};
  int joint = -1;

  friend bool operator==(const VaryingVector&, const VaryingVector&) = default;
};

/// A place in the frame of a link: its coordinates, m, and where these vary the index and 1 into Layout::vectors.
struct LinkPoint {
  Vec2 at{};
  int vector = 0;
};

/// One term of a position: arm exp(i turn) phi, with phi the phasor of `coordinate`, or 1 when coordinate is -1.
struct Arm {
  int coordinate = -1;
  Vec2 arm{};    ///< of a length coordinate: arm / |arm| is meant
  int turn = 0;  ///< index into Layout::turns
  /// Where its numbers vary, the index and 1 into Layout::vectors, negative where the vector is subtracted; else 0.
  int vector = 0;
  /// By which the components may differ because the numbers of the scene that they are sums of are rounded.
  Vec2 rounding{half_unit * std::abs(arm.x), half_unit* std::abs(arm.y)};
  /// By which the components may be others because joints repeat others to rounding only (Layout::loosen).
  Vec2 open{};
};

/// A coordinate of the mechanism: the absolute angle of a frame (all bodies that slides and welds keep parallel
/// share one frame), or the length travelled along a line fixed in a frame.
///
/// Its phasor is  exp(i theta)  for an angle,  s exp(i theta_frame)  or  s  for a length.
struct Coordinate {
  enum class Kind { angle, length };
  Kind kind = Kind::angle;
  std::string name;      ///< body of the angle, joint of the travel, or "block.x" of a body no joint ties to ground
  int frame = -1;        ///< length: coordinate of the angle of the line's frame, -1 when it is fixed
  double start = 0;      ///< guess from the scene, rad or m
  double origin = 0;     ///< of "block.x": the anchor's coordinate, m, from which it is counted in the world
  unsigned reasons = 0;  ///< for which it is kept, one bit each; none if it is dropped

  /// Why it is kept or dropped: "closes a loop, carries weight".
  std::string why() const;
};

/// A body, or a bar, in the spanning tree of joints: origin = origin of parent + sum of arms.
struct Link {
  int body = -1;   ///< index into Scene::bodies, -1 for a bar
  int joint = -1;  ///< bar: index into Scene::joints
  int frame = -1;  ///< coordinate of its angle, -1 when fixed
  int turn = 0;    ///< angle of link = angle of frame + turn; index into Layout::turns
  int parent = -1;
  int depth = 0;
  std::vector<Arm> arms;
};

/// A joint left out of the spanning tree: it closes a loop, sum of arms = 0.
struct Closure {
  int joint = -1;
  int link_a = -1, link_b = -1;
  std::string name;
  std::vector<Arm> arms;
};

/// The structure of a scene, free of any scalar type: spanning tree, coordinates and loop closures.
///
/// Coordinates 0 .. angles-1 are angles, angles .. kept-1 lengths; those from `kept` on carry no load, close no loop
/// and keep their start value.
struct Layout {
  Layout();
  Layout(const Layout&);
  Layout(Layout&&) noexcept;
  Layout& operator=(const Layout&);
  Layout& operator=(Layout&&) noexcept;
  ~Layout();

  std::vector<Coordinate> coordinates;
  int angles = 0;
  int kept = 0;
  std::vector<Turn> turns;      ///< the first is zero
  std::vector<Link> links;      ///< one per body, then one per bar
  std::vector<int> tree_order;  ///< links, parents before children
  std::vector<Closure> closures;
  std::vector<int> travel;             ///< per joint: coordinate of its travel, or -1
  std::vector<int> redundant_angle;    ///< joints whose constant angle follows from other joints
  VaryingNumbers varying;              ///< those that it was made for
  std::vector<VaryingVector> vectors;  ///< that depend on them
  std::vector<std::string> dropped;    ///< items left out of the compiled model, and why
  Vec2 anchor{};      ///< the ground point that sizes are measured from, m: the first that a joint, element, ... uses
  double size = 1.0;  ///< longest distance from the anchor through the tree to a point of a body, m

  /// Of a coordinate; false of -1.
  bool is_length(int i) const { return i >= 0 && coordinates[i].kind == Coordinate::Kind::length; }

  /// Changes the unit of all lengths: multiplies them by `factor`.
  void scale_lengths(double factor);

  /// Where closures repeat others to rounding only, their loops can be closed in several ways. Lets the components of
  /// all arms of a closure's loop differ by up to by[closure] (a length, of a slide's direction a number; 0: by
  /// nothing), for scalars that can say so.
  void loosen(const std::vector<double>& by);

  /// p_b - p_a for points given as (link, local coordinates): arms with common ancestors cancelled, sorted by
  /// coordinate and turn. Arms that differ in neither are summed exactly; a sum that no double holds remains several
  /// arms, of which the last has the rounding of all. Equal numbers of opposite sign cancel with their rounding. Arms
  /// whose numbers vary come behind the others of their coordinate and turn, each vector for itself.
  std::vector<Arm> path_between(int link_a, const LinkPoint& a, int link_b, const LinkPoint& b) const;
  std::vector<Arm> path(int link_a, Vec2 a, int link_b, Vec2 b) const { return path_between(link_a, {a}, link_b, {b}); }
  /// From one point of a body of the scene to another, and from the world's origin.
  std::vector<Arm> path(const Scene& scene, PointRef a, PointRef b) const {
    return path_between(a.body, place_of(scene, a), b.body, place_of(scene, b));
  }
  std::vector<Arm> path_to(const Scene& scene, PointRef p) const {
    return path_between(0, {}, p.body, place_of(scene, p));
  }
  LinkPoint place_of(const Scene& scene, PointRef p) const;

  /// The sum over the points of a force (Force::for_each_point) of their places in the world, sorted by coordinate.
  std::vector<Arm> paths_to(const Scene& scene, const Force& force) const;
};

/// Finds the structure. Throws InputError if welds and slides require contradictory angles. Numbers that vary count as
/// other than zero, whatever they are in the scene: so the structure is that of the scene at all their values.
Layout lay_out(const Scene& scene, Purpose purpose, VaryingNumbers varying = {});

}  // namespace poise
