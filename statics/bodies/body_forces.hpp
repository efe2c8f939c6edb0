#pragma once

// The measures of a scene and the forces on its bodies, each cut free, by vector mechanics: one text for the numbers as
// they are (SceneNumbers) and as variables (Numbers), in the scalar of the poses.

#include <array>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/length_of.hpp"
#include "model/outline.hpp"
#include "model/plain_value.hpp"
#include "model/scene_numbers.hpp"
#include "model/select.hpp"
#include "statics/bodies/body_measures.hpp"
#include "statics/bodies/cam_push.hpp"

namespace poise {
namespace body_forces {

/// |d|; of balls also where they cannot tell it from zero, of dual numbers without derivatives where it is zero.
template <class T>
T length_of(const Planar<T>& d) {
  return poise::length_of(d);
}

/// The force of an effort on a distance that may be zero.
template <class T>
Planar<T> in_any_direction() {
  return {};
}

/// Whether a force and a moment are zero, and stay so; of scalars in lanes, in all of these.
template <class T>
bool is_nothing(const Planar<T>& force, const T& moment) {
  return is_just(force.x, 0.0) && is_just(force.y, 0.0) && is_just(moment, 0.0);
}

/// `some` where a force or a moment is something, `none` in lanes in which both are zero.
template <class T>
T where_something(const Planar<T>& force, const T& moment, const T& some, const T& none) {
  if constexpr (has_lanes<T>) {
    return select(force.x == T(0) && force.y == T(0) && moment == T(0), none, some);
  } else {
    return some;
  }
}

}  // namespace body_forces

/// Where a rope leaves the rim of one contact and meets that of the next, with the direction and length of its straight
/// part.
template <class T>
struct RopePart {
  Planar<T> from, to, along;
  T length;
};

/// A scene with its bodies at poses, measured from any point of the world. `NumbersOfScene` is SceneNumbers<T> or
/// Numbers<T>, with T the scalar of the poses. Keeps a reference to the poses.
template <class Pose, class NumbersOfScene = SceneNumbers<ScalarOf<Pose>>>
class BodyForces {
 public:
  using T = ScalarOf<Pose>;

  BodyForces(const NumbersOfScene& numbers, const std::vector<Pose>& poses) : numbers_(numbers), poses_(poses) {}
  BodyForces(const Scene& scene, const std::vector<Pose>& poses) : BodyForces(SceneNumbers<T>(scene), poses) {}

  const Scene& scene() const { return numbers_.scene(); }
  const NumbersOfScene& numbers() const { return numbers_; }

  Planar<T> world(PointRef p) const { return at(p.body).origin + numbers_.point(p) * at(p.body).direction(); }
  /// The line along which a joint's second point travels, a unit vector.
  Planar<T> axis(int joint) const { return numbers_.axis(joint) * at(joint_of(joint).a.body).direction(); }
  /// The line of a component, a unit vector.
  Planar<T> axis(const Measure& component) const {
    return planar_cast<T>(direction<PlainOf<T>>(component.axis)) * at(component.a.body).direction();
  }

  /// The place of the point of a clearance, or of the centre of a circle along an outline, as OutlineIn has it: in the
  /// frame of the outline's body, from the outline's first point.
  Planar<T> place_at_outline(const Measure& measure) const {
    return (world(measure.b) - world(measure.a)) * conj(at(measure.a.body).direction());
  }
  OutlineIn<T> outline(const Measure& measure) const;

  /// Between the contacts k and k + 1. From the triangle of the line of centres and the two radii: the straight part is
  /// turned from the line of centres by the angle whose sine is the difference of the signed radii over the distance.
  RopePart<T> rope_part(const Measure& rope, std::size_t k) const;

  /// Value of a measure; of that of a stop, of index `stop`, with the numbers of its coupling.
  T value(const Measure& measure, int stop = -1) const;
  /// g of a stop less its max (`upper`), or its min.
  T overrun(int stop, bool upper) const { return value(stop_of(stop).on, stop) - numbers_.limit(stop, upper); }

  /// Calls visit(UnitEffortOf<T>) for what an effort on a measure does to bodies, positive if it tends to increase it:
  /// once, or for each part of a rope and each term of a sum. `stop` as of value().
  template <class Visit>
  void for_each_effort(const Measure& measure, const T& effort, Visit visit, int stop = -1) const;

  /// Weights, forces and torques with their sources: push(kind, name, body, at, force, moment), with "weight" of a
  /// body, "force", "torque".
  template <class Push>
  void push_loads(Push push) const;

  /// The static force of an element, positive if it tends to reduce its measure.
  T element_force(int element) const { return force_at(element, value(element_of(element).on)).value; }
  /// Its derivative by that measure.
  T element_rate(int element) const { return force_at(element, value(element_of(element).on)).by_measure; }
  /// What it does to bodies: push(body, at, force, moment). Returns its static force, 0 where it has no direction.
  template <class Push>
  T push_element(int element, Push push) const;

  /// What the efforts z of a joint do together, one for each of its constraints: force x and y of a pin on its second
  /// body, force normal to the axis of a slide, pressure of a bar, moment of a joint that keeps an angle. A bar of
  /// length zero presses along x.
  UnitEffortOf<T> joint_effort(int joint, const T* z) const;
  /// Calls act(UnitEffortOf<T>) for a unit of each.
  template <class Act>
  void for_each_joint_effort(int joint, Act act) const;

  /// Potential of loads, weights and elements; forces that follow bodies have none.
  T energy() const;

 private:
  const Pose& at(int body) const { return poses_[static_cast<std::size_t>(body)]; }
  const Joint& joint_of(int joint) const { return scene().joints[static_cast<std::size_t>(joint)]; }
  const Stop& stop_of(int stop) const { return scene().stops[static_cast<std::size_t>(stop)]; }
  const Element& element_of(int element) const { return scene().elements[static_cast<std::size_t>(element)]; }

  LawForce<T> force_at(int element, const T& g) const {
    return numbers_.with_law(element, [&]<class L>(const L& law) {
      if constexpr (StoresEnergy<L>)
        return law.at_rest(g);
      else
        return LawForce<T>{};
    });
  }

  // Of what acts at each of the points of Force::for_each_point().
  Planar<T> share_of(int force) const {
    const Force& f = scene().forces[static_cast<std::size_t>(force)];
    Planar<T> vector = numbers_.force(force);
    if (f.follows >= 0) vector = vector * at(f.follows).direction();
    return f.to ? T(norm(numbers_.point(*f.to) - numbers_.point(f.at)) / T(2)) * vector : vector;
  }

  NumbersOfScene numbers_;
  const std::vector<Pose>& poses_;
};

template <class Pose>
BodyForces(const Scene&, const std::vector<Pose>&) -> BodyForces<Pose>;

template <class Pose, class NumbersOfScene>
auto BodyForces<Pose, NumbersOfScene>::rope_part(const Measure& rope, std::size_t k) const -> RopePart<T> {
  const RopeContact& a = rope.contacts[k];
  const RopeContact& b = rope.contacts[k + 1];
  const Planar<T> centre_a = world(a.at);
  const Planar<T> centre_b = world(b.at);
  const T r_a(a.turn * a.radius), r_b(b.turn * b.radius);
  const Planar<T> d = centre_b - centre_a;
  const T apart = body_forces::length_of(d);
  const Planar<T> towards = T(1) / apart * d;
  const T sine = (r_b - r_a) / apart;
  using std::sqrt;
  const Planar<T> along = towards * Planar<T>{sqrt(T(T(1) - sine * sine)), -sine};
  const Planar<T> left = quarter_turn(along);
  return {centre_a - r_a * left, centre_b - r_b * left, along, dot(along, d)};
}

template <class Pose, class NumbersOfScene>
auto BodyForces<Pose, NumbersOfScene>::outline(const Measure& measure) const -> OutlineIn<T> {
  OutlineIn<T> out(measure.outline, [&](PointRef point) { return scene().local(point); });
  std::vector<Planar<T>> points;
  for (const PointRef& point : measure.outline.points) {
    points.push_back(numbers_.point(point) - numbers_.point(measure.a));
  }
  out.set_points(std::move(points));
  return out;
}

template <class Pose, class NumbersOfScene>
auto BodyForces<Pose, NumbersOfScene>::value(const Measure& measure, int stop) const -> T {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return at(measure.body_b).angle - at(measure.body_a).angle;
    case Measure::Kind::distance:
      return body_forces::length_of(world(measure.b) - world(measure.a));
    case Measure::Kind::travel: {
      const Joint& joint = joint_of(measure.joint);
      return dot(axis(measure.joint), world(joint.b) - world(joint.a));
    }
    case Measure::Kind::x:
      return world(measure.b).x - at(0).origin.x;
    case Measure::Kind::y:
      return world(measure.b).y - at(0).origin.y;
    case Measure::Kind::component:
      return dot(axis(measure), world(measure.b) - world(measure.a));
    case Measure::Kind::rope: {
      T length(0);
      Planar<T> before{};
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const RopePart<T> part = rope_part(measure, k);
        const RopeContact& contact = measure.contacts[k];
        if (k > 0 && contact.radius > 0) length += T(contact.radius) * rope_wrap(before, part.along, contact.turn);
        length += part.length;
        before = part.along;
      }
      return length;
    }
    case Measure::Kind::clearance:
      return outline(measure).clearance(place_at_outline(measure)).value;
    case Measure::Kind::along_outline:
      return outline(measure).along(place_at_outline(measure), T(measure.radius)).value;
    case Measure::Kind::slip_on_cam:
      return T(0);  // Friction does not depend on how far something has slipped.
    case Measure::Kind::sum:
      break;
  }
  T sum(0);
  for (std::size_t k = 0; k < measure.terms.size(); ++k) {
    const auto term = numbers_.term(measure, k, stop);
    const T g = value(measure.terms[k].measure);
    sum += term.factor * (term.has_profile() ? term.at(g).value : g);
  }
  return sum;
}

template <class Pose, class NumbersOfScene>
template <class Visit>
void BodyForces<Pose, NumbersOfScene>::for_each_effort(const Measure& measure, const T& effort, Visit visit,
                                                       int stop) const {
  using Effort = UnitEffortOf<T>;
  switch (measure.kind) {
    case Measure::Kind::angle:
      visit(Effort{measure.body_a, measure.body_b, at(measure.body_a).origin, at(measure.body_b).origin, {}, effort});
      return;
    case Measure::Kind::distance: {
      const Planar<T> a = world(measure.a);
      const Planar<T> b = world(measure.b);
      const T r = body_forces::length_of(b - a);
      const Planar<T> along = choose(
          r > T(0), [&]() -> Planar<T> { return T(effort / r) * (b - a); },
          [&]() -> Planar<T> { return effort * body_forces::in_any_direction<T>(); });
      visit(Effort{measure.a.body, measure.b.body, a, b, along, T(0)});
      return;
    }
    case Measure::Kind::travel: {
      // Along the line of body a, at the point of body b that slides on it.
      const Joint& joint = joint_of(measure.joint);
      const Planar<T> b = world(joint.b);
      visit(Effort{joint.a.body, joint.b.body, b, b, effort * axis(measure.joint), T(0)});
      return;
    }
    case Measure::Kind::x:
    case Measure::Kind::y: {
      const Planar<T> b = world(measure.b);
      const Planar<T> along = measure.kind == Measure::Kind::x ? Planar<T>{effort, T(0)} : Planar<T>{T(0), effort};
      visit(Effort{0, measure.b.body, b, b, along, T(0)});
      return;
    }
    case Measure::Kind::component: {
      // Along the axis of body a, at the point of body b.
      const Planar<T> b = world(measure.b);
      visit(Effort{measure.a.body, measure.b.body, b, b, effort * axis(measure), T(0)});
      return;
    }
    case Measure::Kind::rope:
      for (std::size_t k = 0; k + 1 < measure.contacts.size(); ++k) {
        const RopePart<T> part = rope_part(measure, k);
        visit(Effort{measure.contacts[k].at.body, measure.contacts[k + 1].at.body, part.from, part.to,
                     effort * part.along, T(0)});
      }
      return;
    case Measure::Kind::clearance: {
      // Square to the outline, where it is nearest to the point.
      const PlaneValue<T> g = outline(measure).clearance(place_at_outline(measure));
      const Planar<T> away = Planar<T>{g.x, g.y} * at(measure.a.body).direction();
      const Planar<T> touched = world(measure.b) - g.value * away;
      visit(Effort{measure.a.body, measure.b.body, touched, touched, effort * away, T(0)});
      return;
    }
    case Measure::Kind::along_outline: {
      const PlaneValue<T> g = outline(measure).along(place_at_outline(measure), T(measure.radius));
      const Planar<T> along = Planar<T>{g.x, g.y} * at(measure.a.body).direction();
      const Planar<T> b = world(measure.b);
      visit(Effort{measure.a.body, measure.b.body, b, b, effort * along, T(0)});
      return;
    }
    case Measure::Kind::slip_on_cam: {
      // Along the cam, and longer than the effort as the normal force is.
      const std::optional<CamPush<T>> push =
          cam_push(*this, measure.stop, *cam_geometry(scene(), stop_of(measure.stop)));
      const Planar<T> b = world(measure.b);
      Planar<T> along{};
      if (push) along = T(effort / push->lever) * (quarter_turn(push->along) - push->tangent * push->along);
      visit(Effort{measure.a.body, measure.b.body, b, b, along, T(0)});
      return;
    }
    case Measure::Kind::sum:
      break;
  }
  for (std::size_t k = 0; k < measure.terms.size(); ++k) {
    const auto term = numbers_.term(measure, k, stop);
    const Measure& of = measure.terms[k].measure;
    T share = effort * term.factor;
    if (term.has_profile()) share = share * term.at(value(of)).first;
    for_each_effort(of, share, visit);
  }
}

template <class Pose, class NumbersOfScene>
template <class Push>
void BodyForces<Pose, NumbersOfScene>::push_loads(Push push) const {
  const Scene& scene = this->scene();
  for (int i = 1; i < static_cast<int>(scene.bodies.size()); ++i) {
    const T mass = numbers_.mass(i);
    if (is_just(mass, 0.0)) continue;
    const Planar<T> center = at(i).origin + numbers_.center(i) * at(i).direction();
    push("weight", scene.bodies[static_cast<std::size_t>(i)].name, i, center, mass * numbers_.gravity(), T(0));
  }
  for (int f = 0; f < static_cast<int>(scene.forces.size()); ++f) {
    const Force& force = scene.forces[static_cast<std::size_t>(f)];
    const Planar<T> share = share_of(f);
    force.for_each_point([&](PointRef point) { push("force", force.name, point.body, world(point), share, T(0)); });
  }
  for (int t = 0; t < static_cast<int>(scene.torques.size()); ++t) {
    const Torque& torque = scene.torques[static_cast<std::size_t>(t)];
    push("torque", torque.name, torque.body, at(torque.body).origin, Planar<T>{}, T(numbers_.torque(t)));
  }
}

template <class Pose, class NumbersOfScene>
template <class Push>
auto BodyForces<Pose, NumbersOfScene>::push_element(int element, Push push) const -> T {
  const Element& of = element_of(element);
  T out(0);
  if (!stores_energy(of.law)) return out;
  const auto act = [&](const UnitEffortOf<T>& on) {
    push(on.body_a, on.a, on.force, on.moment);
    push(on.body_b, on.b, -on.force, T(-on.moment));
  };
  const T g = value(of.on);
  if constexpr (HasDerivatives<T>) {
    if (of.on.kind == Measure::Kind::distance && is_zero(g)) {
      // Its points coincide: a force that vanishes there is the slope beyond times b - a, which has derivatives.
      const T slope = force_at(element, T(std::numeric_limits<double>::min())).by_measure;
      const Planar<T> a = world(of.on.a), b = world(of.on.b);
      act({of.on.a.body, of.on.b.body, a, b, slope * (b - a), T(0)});
      return out;
    }
  }
  const T force = force_at(element, g).value;
  if (is_just(force, 0.0)) return out;
  for_each_effort(of.on, T(1), [&](const UnitEffortOf<T>& unit) {
    if (body_forces::is_nothing(unit.force, unit.moment)) return;
    out = body_forces::where_something(unit.force, unit.moment, force, out);
    act({unit.body_a, unit.body_b, unit.a, unit.b, force * unit.force, T(force * unit.moment)});
  });
  return out;
}

template <class Pose, class NumbersOfScene>
auto BodyForces<Pose, NumbersOfScene>::joint_effort(int joint, const T* z) const -> UnitEffortOf<T> {
  const Joint& of = joint_of(joint);
  const Planar<T> b = world(of.b);
  UnitEffortOf<T> out{of.a.body, of.b.body, b, b, {}, T(0)};
  if (of.keeps_length()) {
    out.a = world(of.a);
    const Planar<T> along = b - out.a;
    const T r = norm(along);
    out.force = choose(
        r > T(0), [&]() -> Planar<T> { return T(*z / r) * along; },
        [&] {
          return Planar<T>{*z, T(0)};
        });
    ++z;
  } else if (of.has_travel()) {
    out.force = *z++ * quarter_turn(axis(joint));
  } else {
    out.force.x = *z++;
    out.force.y = *z++;
  }
  if (of.keeps_angle()) out.moment = *z;
  return out;
}

template <class Pose, class NumbersOfScene>
template <class Act>
void BodyForces<Pose, NumbersOfScene>::for_each_joint_effort(int joint, Act act) const {
  const Joint& of = joint_of(joint);
  const int forces = of.traits().constraints() - (of.keeps_angle() ? 1 : 0);
  UnitEffortOf<T> unit;
  for (int k = 0; k < forces; ++k) {
    std::array<T, 3> z{T(0), T(0), T(0)};
    z[static_cast<std::size_t>(k)] = T(1);
    unit = joint_effort(joint, z.data());
    act(unit);
  }
  if (!of.keeps_angle()) return;
  unit.force = {};
  unit.moment = T(1);
  act(unit);
}

template <class Pose, class NumbersOfScene>
auto BodyForces<Pose, NumbersOfScene>::energy() const -> T {
  const Scene& scene = this->scene();
  T sum(0);
  for (int i = 1; i < static_cast<int>(scene.bodies.size()); ++i) {
    const Planar<T> center = at(i).origin + numbers_.center(i) * at(i).direction();
    sum -= numbers_.mass(i) * dot(numbers_.gravity(), center);
  }
  for (int f = 0; f < static_cast<int>(scene.forces.size()); ++f) {
    const Planar<T> share = share_of(f);
    scene.forces[static_cast<std::size_t>(f)].for_each_point([&](PointRef point) { sum -= dot(share, world(point)); });
  }
  for (int t = 0; t < static_cast<int>(scene.torques.size()); ++t) {
    sum -= numbers_.torque(t) * at(scene.torques[static_cast<std::size_t>(t)].body).angle;
  }
  for (int e = 0; e < static_cast<int>(scene.elements.size()); ++e) {
    if (!stores_energy(element_of(e).law)) continue;
    const T g = value(element_of(e).on);
    numbers_.with_law(e, [&]<class L>(const L& law) {
      if constexpr (StoresEnergy<L>) sum += law.energy(g);
    });
  }
  return sum;
}

template <class Pose>
ScalarOf<Pose> value_of(const Scene& scene, const Measure& measure, const std::vector<Pose>& poses) {
  return BodyForces(scene, poses).value(measure);
}

template <class Pose>
std::vector<UnitEffortOf<ScalarOf<Pose>>> unit_efforts(const Scene& scene, const Measure& measure,
                                                       const std::vector<Pose>& poses) {
  using T = ScalarOf<Pose>;
  std::vector<UnitEffortOf<T>> out;
  BodyForces(scene, poses).for_each_effort(measure, T(1), [&](const UnitEffortOf<T>& effort) {
    out.push_back(effort);
  });
  return out;
}

}  // namespace poise
