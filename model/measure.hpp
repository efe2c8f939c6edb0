#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include "model/dimension.hpp"
#include "model/point_ref.hpp"
#include "model/value_range.hpp"

namespace poise {

/// A scalar function g of the pose, as a scene declares it. Force elements, stops, drives and sensors act on measures.
/// Compiled forms with derivatives: model/measures/.
///
/// angle     angle(body_b) - angle(body_a), rad, unwrapped: turns count
/// distance  |b - a| of two points, m
/// travel    of a slide or pin in a slot: signed distance from its point a to its point b along the axis, m
/// x, y      world coordinate of point b, m
/// sum       sum of factor_i g_i over `terms`; all terms are angles, or all are lengths
struct Measure {
  enum class Kind { angle, distance, travel, x, y, sum };
  struct Term;

  Kind kind = Kind::angle;
  int body_a = 0, body_b = 0;
  PointRef a, b;
  int joint = -1;  ///< travel: index into Scene::joints
  std::vector<Term> terms;

  static Measure angle_between(int body_a, int body_b);
  static Measure distance_between(PointRef a, PointRef b);
  static Measure travel_of(int joint);
  static Measure x_of(PointRef point);
  static Measure y_of(PointRef point);
  static Measure sum_of(std::vector<Term> terms);

  /// True if g is an angle, rad; otherwise it is a length, m.
  bool is_angle() const;
  Dimension dimension() const { return is_angle() ? dimension::angle : dimension::length; }
  /// Dimension of the conjugate effort: a torque, N m, or a force, N.
  Dimension effort_dimension() const { return is_angle() ? dimension::torque : dimension::force; }
  /// Values that g can take: a distance is not negative.
  Range range() const { return kind == Kind::distance ? Range::not_negative : Range::finite; }
};

struct Measure::Term {
  double factor = 1.0;
  Measure measure;
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

inline Measure Measure::sum_of(std::vector<Term> terms) {
  Measure m;
  m.kind = Kind::sum;
  m.terms = std::move(terms);
  return m;
}

inline bool Measure::is_angle() const {
  if (kind == Kind::sum) return !terms.empty() && terms.front().measure.is_angle();
  return kind == Kind::angle;
}

}  // namespace poise
