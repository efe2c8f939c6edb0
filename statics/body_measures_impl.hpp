#pragma once

#include "statics/body_measures.hpp"

namespace poise {
namespace body_measures {

template <class Pose>
auto world(const Scene& scene, const std::vector<Pose>& poses, PointRef p) {
  return poses[p.body].world(scene.local(p));
}

/// Of the line along which a joint's second point travels.
template <class Pose>
auto axis_of(const Joint& joint, const std::vector<Pose>& poses) {
  return direction<ScalarOf<Pose>>(joint.axis) * poses[joint.a.body].direction();
}

/// |d|, also where balls cannot tell it from zero.
template <class T>
T length_of(const Planar<T>& d) {
  return norm(d);
}

/// The force of an effort on a distance that may be zero.
template <class T>
Planar<T> in_any_direction() {
  return {};
}

/// Component of the axis of a measure, a unit vector.
template <class Pose>
auto axis_of(const Measure& measure, const std::vector<Pose>& poses) {
  return direction<ScalarOf<Pose>>(measure.axis) * poses[measure.a.body].direction();
}

/// Where a rope leaves the rim of one contact and meets that of the next, k and k + 1.
template <class T>
struct RopePart {
  Planar<T> from, to, along;
  T length;
};

/// From the triangle of the line of centres and the two radii: the straight part is turned from the line of centres by
/// the angle whose sine is the difference of the signed radii over the distance.
template <class Pose, class T = ScalarOf<Pose>>
RopePart<T> rope_part(const Scene& scene, const Measure& measure, std::size_t k, const std::vector<Pose>& poses) {
  const RopeContact& a = measure.contacts[k];
  const RopeContact& b = measure.contacts[k + 1];
  const Planar<T> centre_a = world(scene, poses, a.at);
  const Planar<T> centre_b = world(scene, poses, b.at);
  const T r_a(a.turn * a.radius), r_b(b.turn * b.radius);
  const Planar<T> d = centre_b - centre_a;
  const T apart = length_of(d);
  const Planar<T> towards = T(1) / apart * d;
  const T sine = (r_b - r_a) / apart;
  using std::sqrt;
  const Planar<T> along = towards * Planar<T>{sqrt(T(T(1) - sine * sine)), -sine};
  const Planar<T> left = quarter_turn(along);
  return {centre_a - r_a * left, centre_b - r_b * left, along, dot(along, d)};
}

template <class Pose, class T = ScalarOf<Pose>>
void add_efforts(const Scene& scene, const Measure& measure, const std::vector<Pose>& poses, const T& factor,
                 std::vector<UnitEffortOf<T>>& out) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      out.push_back(
          {measure.body_a, measure.body_b, poses[measure.body_a].origin, poses[measure.body_b].origin, {}, factor});
      break;
    case Measure::Kind::distance: {
      const Planar<T> a = world(scene, poses, measure.a);
      const Planar<T> b = world(scene, poses, measure.b);
      const T r = length_of(b - a);
      const Planar<T> along = r > 0 ? (factor / r) * (b - a) : factor * in_any_direction<T>();
      out.push_back({measure.a.body, measure.b.body, a, b, along, T(0)});
      break;
    }
    case Measure::Kind::travel: {
      // Along the line of body a, at the point of body b that slides on it.
      const Joint& joint = scene.joints[measure.joint];
      const Planar<T> at = world(scene, poses, joint.b);
      out.push_back({joint.a.body, joint.b.body, at, at, factor * axis_of(joint, poses), T(0)});
      break;
    }
    case Measure::Kind::x:
    case Measure::Kind::y: {
      const Planar<T> at = world(scene, poses, measure.b);
      const Planar<T> along = measure.kind == Measure::Kind::x ? Planar<T>{factor, T(0)} : Planar<T>{T(0), factor};
      out.push_back({0, measure.b.body, at, at, along, T(0)});
      break;
    }
    case Measure::Kind::component: {
      // Along the axis of body a, at the point of body b.
      const Planar<T> at = world(scene, poses, measure.b);
      out.push_back({measure.a.body, measure.b.body, at, at, factor * axis_of(measure, poses), T(0)});
      break;
    }
    case Measure::Kind::rope:
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const RopePart<T> part = rope_part(scene, measure, k, poses);
        out.push_back({measure.contacts[k].at.body, measure.contacts[k + 1].at.body, part.from, part.to,
                       factor * part.along, T(0)});
      }
      break;
    case Measure::Kind::sum:
      for (const Measure::Term& term : measure.terms) {
        T share = factor * T(term.factor);
        if (term.profile) share = share * profile_of<T>(term).at(value_of(scene, term.measure, poses)).first;
        add_efforts(scene, term.measure, poses, share, out);
      }
      break;
  }
}

}  // namespace body_measures

template <class Pose>
ScalarOf<Pose> value_of(const Scene& scene, const Measure& measure, const std::vector<Pose>& poses) {
  using T = ScalarOf<Pose>;
  using body_measures::axis_of;
  using body_measures::length_of;
  using body_measures::rope_part;
  using body_measures::world;
  switch (measure.kind) {
    case Measure::Kind::angle:
      return poses[measure.body_b].angle - poses[measure.body_a].angle;
    case Measure::Kind::distance:
      return length_of(world(scene, poses, measure.b) - world(scene, poses, measure.a));
    case Measure::Kind::travel: {
      const Joint& joint = scene.joints[measure.joint];
      return dot(axis_of(joint, poses), world(scene, poses, joint.b) - world(scene, poses, joint.a));
    }
    case Measure::Kind::x:
      return world(scene, poses, measure.b).x - poses[0].origin.x;
    case Measure::Kind::y:
      return world(scene, poses, measure.b).y - poses[0].origin.y;
    case Measure::Kind::component:
      return dot(axis_of(measure, poses), world(scene, poses, measure.b) - world(scene, poses, measure.a));
    case Measure::Kind::rope: {
      T length(0);
      Planar<T> before{};
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const auto part = rope_part(scene, measure, k, poses);
        const RopeContact& contact = measure.contacts[k];
        if (k > 0 && contact.radius > 0) length += T(contact.radius) * rope_wrap(before, part.along, contact.turn);
        length += part.length;
        before = part.along;
      }
      return length;
    }
    case Measure::Kind::sum:
      break;
  }
  T sum(0);
  for (const Measure::Term& term : measure.terms) {
    const T value = value_of(scene, term.measure, poses);
    sum += T(term.factor) * (term.profile ? profile_of<T>(term).at(value).value : value);
  }
  return sum;
}

template <class Pose>
std::vector<UnitEffortOf<ScalarOf<Pose>>> unit_efforts(const Scene& scene, const Measure& measure,
                                                       const std::vector<Pose>& poses) {
  std::vector<UnitEffortOf<ScalarOf<Pose>>> out;
  body_measures::add_efforts(scene, measure, poses, ScalarOf<Pose>(1), out);
  return out;
}

}  // namespace poise
