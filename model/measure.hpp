#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "model/dimension.hpp"
#include "model/planar.hpp"
#include "model/point_ref.hpp"
#include "model/profile.hpp"
#include "model/value_range.hpp"

namespace poise {

/// A point that a rope touches: an end, an eye, or the rim of a round pulley around the point.
struct RopeContact {
  PointRef at;
  double radius = 0.0;  ///< of the pulley, m; 0 of a point
  int turn = 1;         ///< the rope passes round the pulley counter-clockwise (1) or clockwise (-1)
  /// Coefficient mu with which a rope that does not stretch rubs on the rim: over a wrap by the angle w its tensions on
  /// both sides differ by at most the factor exp(mu w) (L. Euler, 1769; J. Eytelwein, 1808). Statics only: poses that
  /// it holds (statics/friction/held.hpp).
  std::optional<double> friction{};
};

/// What a point or a circle of another body touches, along a way on whose left it is and on whose right the body is.
///
/// polygon     straight edges from each of the points to the next and from the last one back to the first, clockwise
///             around a convex body; with `backed` behind a last point of its own, half as far behind the middle
///             between the first point and the last as they are apart: so a single segment has a body behind it
/// arc         around the first point, clockwise from the second to the third, with the body inside; a full circle
///             where these two are one
/// hollow_arc  the same counter-clockwise, with the body outside
///
/// An arc has the radius of its second point; the third gives the direction of its end.
struct Outline {
  enum class Form { polygon, arc, hollow_arc };
  Form form = Form::polygon;
  std::vector<PointRef> points{};  ///< of one body
  bool backed = false;

  friend bool operator==(const Outline&, const Outline&) = default;
};

/// A scalar function g of the pose, as a scene declares it. Force elements, stops, drives and sensors act on measures.
/// Compiled forms with derivatives: model/measures/.
///
/// angle      angle(body_b) - angle(body_a), rad, unwrapped: turns count
/// distance   |b - a| of two points, m
/// travel     of a slide or pin in a slot: signed distance from its point a to its point b along the axis, m
/// x, y       world coordinate of point b, m
/// component  of b - a along `axis`, a direction fixed in the body of point a, m
/// rope       length of a taut rope over `contacts`: straight between them, and along the rims of pulleys, m
/// clearance  of point b from an outline of another body, m: the distance from what is nearest of it, an edge, a corner
///            or the arc; negative inside
/// along_outline  way of the centre b of a circle along an outline, m, as its contact goes: along an edge or arc, and
///            by `radius` times the angle around a corner. Less the circle's turning it is how far it slips (slip_on())
/// slip_on_cam  how far the edge `b` of a cam's follower slips along the cam, from point a of the cam, its axis
///            (model/measures/cam_slip.hpp); an angle where the follower's measure is one
/// sum        sum of factor_i g_i, or of factor_i P_i(g_i), over `terms`; an angle if all terms without a profile P are
///            angles, otherwise a length, with factors in m/rad of angles and in m of profiles
struct Measure {
  enum class Kind { angle, distance, travel, x, y, component, rope, clearance, along_outline, slip_on_cam, sum };
  struct Term;

  Kind kind = Kind::angle;
  int body_a = 0, body_b = 0;
  PointRef a, b;
  int joint = -1;       ///< travel: index into Scene::joints
  Vec2 axis{1.0, 0.0};  ///< component: of any length, only its direction matters
  std::vector<RopeContact> contacts;
  Outline outline;      ///< clearance, along_outline: of the body of point a, the first of its points
  double radius = 0.0;  ///< along_outline, m
  int stop = -1;        ///< slip_on_cam: the cam, index into Scene::stops
  bool turns = false;   ///< slip_on_cam: the follower's measure is an angle
  std::vector<Term> terms;

  static Measure angle_between(int body_a, int body_b);
  static Measure distance_between(PointRef a, PointRef b);
  static Measure travel_of(int joint);
  static Measure x_of(PointRef point);
  static Measure y_of(PointRef point);
  static Measure component_along(PointRef a, PointRef b, Vec2 axis);
  static Measure rope_over(std::vector<RopeContact> contacts);
  static Measure clearance_of(PointRef point, Outline outline);
  /// How far a circle around the point of a clearance slips along the outline where it touches: its rate is that of the
  /// circle's point at the contact against the outline's, along the way of the outline.
  static Measure slip_on(const Measure& clearance, double radius);
  static Measure sum_of(std::vector<Term> terms);

  /// True if g is an angle, rad; otherwise it is a length, m.
  bool is_angle() const;
  Dimension dimension() const { return is_angle() ? dimension::angle : dimension::length; }
  /// Dimension of the conjugate effort: a torque, N m, or a force, N.
  Dimension effort_dimension() const { return is_angle() ? dimension::torque : dimension::force; }
  /// Values that g can take: a distance is not negative.
  Range range() const { return kind == Kind::distance || kind == Kind::rope ? Range::not_negative : Range::finite; }
};

struct Measure::Term {
  double factor = 1.0;
  Measure measure;
  /// If given the term is  factor P((g - shift) / span),  with span a full turn where g is an angle.
  std::shared_ptr<const Profile> profile{};
  double shift = 0.0;  ///< rad or m
  double span = 1.0;   ///< m, of a length g
  int number = -1;     ///< place of the factor among the numbers of a NumberList, where it is one of them

  /// What the factor multiplies.
  Dimension dimension() const { return profile ? dimension::none : measure.dimension(); }
};

inline Measure Measure::angle_between(int body_a, int body_b) {
  Measure m;
  m.body_a = body_a;
  m.body_b = body_b;
  return m;
}

inline Measure Measure::distance_between(PointRef a, PointRef b) {
  Measure m;
  m.kind = Kind::distance;
  m.a = a;
  m.b = b;
  return m;
}

inline Measure Measure::travel_of(int joint) {
  Measure m;
  m.kind = Kind::travel;
  m.joint = joint;
  return m;
}

inline Measure Measure::x_of(PointRef point) {
  Measure m;
  m.kind = Kind::x;
  m.b = point;
  return m;
}

inline Measure Measure::y_of(PointRef point) {
  Measure m = x_of(point);
  m.kind = Kind::y;
  return m;
}

inline Measure Measure::component_along(PointRef a, PointRef b, Vec2 axis) {
  Measure m = distance_between(a, b);
  m.kind = Kind::component;
  m.axis = axis;
  return m;
}

inline Measure Measure::rope_over(std::vector<RopeContact> contacts) {
  Measure m;
  m.kind = Kind::rope;
  m.contacts = std::move(contacts);
  return m;
}

inline Measure Measure::clearance_of(PointRef point, Outline outline) {
  Measure m = distance_between(outline.points.front(), point);
  m.kind = Kind::clearance;
  m.outline = std::move(outline);
  return m;
}

inline Measure Measure::slip_on(const Measure& clearance, double radius) {
  Measure along = clearance;
  along.kind = Kind::along_outline;
  along.radius = radius;
  if (radius == 0.0) return along;
  const int body = clearance.b.body, of_outline = clearance.a.body;
  return sum_of({{1.0, std::move(along)}, {radius, angle_between(of_outline, body)}});
}

inline Measure Measure::sum_of(std::vector<Term> terms) {
  Measure m;
  m.kind = Kind::sum;
  m.terms = std::move(terms);
  return m;
}

inline bool Measure::is_angle() const {
  if (kind == Kind::sum) {
    return std::all_of(terms.begin(), terms.end(),
                       [](const Term& term) { return term.profile != nullptr || term.measure.is_angle(); });
  }
  return kind == Kind::angle || (kind == Kind::slip_on_cam && turns);
}

}  // namespace poise
