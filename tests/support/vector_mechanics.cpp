#include "tests/support/vector_mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace poise::test {

Vec2 world(const Scene& scene, PointRef p, const Poses& poses) { return poses[p.body].world(scene.local(p)); }

double potential_energy(const Scene& scene, const Poses& poses) {
  double v = 0.0;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    v -= body.mass * dot(scene.gravity, poses[i].world(body.center));
  }
  for (const Force& force : scene.forces) {
    if (force.follows < 0) v -= dot(force.vector, world(scene, force.at, poses));
  }
  for (const Torque& torque : scene.torques) v -= torque.value * poses[torque.body].angle;
  for (const Element& element : scene.elements) {
    const double g = measured(scene, element.on, poses);
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (spring == nullptr) {
      v += energy(element.law, g);
      continue;
    }
    const double stretch = g - spring->free_length;
    if (spring->acts == LinearSpring::Acts::tension && stretch < 0) continue;
    if (spring->acts == LinearSpring::Acts::compression && stretch > 0) continue;
    v += spring->stiffness / 2 * stretch * stretch;
  }
  return v;
}

Vec2 gap(const Scene& scene, int joint, double travel, const Poses& poses) {
  const Joint& j = scene.joints[joint];
  const Vec2 apart = world(scene, j.b, poses) - world(scene, j.a, poses);
  if (j.has_travel()) return apart - travel * (j.direction() * unit(poses[j.a.body].angle));
  if (j.kind != Joint::Kind::bar) return apart;
  const auto bars_before = std::count_if(scene.joints.begin(), scene.joints.begin() + joint,
                                         [](const Joint& other) { return other.kind == Joint::Kind::bar; });
  const BodyPose<double>& bar = poses[scene.bodies.size() + static_cast<std::size_t>(bars_before)];
  return apart - j.length * unit(bar.angle);
}

namespace {

/// Straight parts by Pythagoras, wraps as differences of their directions: those of the lines of centres, turned by the
/// angle whose sine is the difference of the radii over the distance.
double rope_length(const Scene& scene, const Measure& rope, const Poses& poses) {
  double length = 0.0, before = 0.0;
  for (std::size_t k = 0; k + 1 < rope.contacts.size(); ++k) {
    const RopeContact& a = rope.contacts[k];
    const RopeContact& b = rope.contacts[k + 1];
    const Vec2 d = world(scene, b.at, poses) - world(scene, a.at, poses);
    const double apart = std::hypot(d.x, d.y), offset = b.turn * b.radius - a.turn * a.radius;
    const double direction = std::atan2(d.y, d.x) - std::asin(offset / apart);
    length += std::sqrt(apart * apart - offset * offset);
    if (k > 0) {
      double wrap = std::fmod(a.turn * (direction - before), 2 * M_PI);
      if (wrap < -0.5 * M_PI) wrap += 2 * M_PI;
      if (wrap > 1.5 * M_PI) wrap -= 2 * M_PI;
      length += a.radius * wrap;
    }
    before = direction;
  }
  return length;
}

}  // namespace

double measured(const Scene& scene, const Measure& measure, const Poses& poses) {
  switch (measure.kind) {
    case Measure::Kind::angle:
      return poses[measure.body_b].angle - poses[measure.body_a].angle;
    case Measure::Kind::distance:
      return norm(world(scene, measure.b, poses) - world(scene, measure.a, poses));
    case Measure::Kind::travel: {
      const Joint& joint = scene.joints[measure.joint];
      return dot(joint.direction() * unit(poses[joint.a.body].angle),
                 world(scene, joint.b, poses) - world(scene, joint.a, poses));
    }
    case Measure::Kind::x:
      return world(scene, measure.b, poses).x;
    case Measure::Kind::y:
      return world(scene, measure.b, poses).y;
    case Measure::Kind::component: {
      const Vec2 axis = (1 / norm(measure.axis)) * measure.axis * unit(poses[measure.a.body].angle);
      return dot(axis, world(scene, measure.b, poses) - world(scene, measure.a, poses));
    }
    case Measure::Kind::rope:
      return rope_length(scene, measure, poses);
    case Measure::Kind::sum:
      break;
  }
  double sum = 0.0;
  for (const Measure::Term& term : measure.terms) {
    const double g = measured(scene, term.measure, poses);
    const double span = term.measure.is_angle() ? 2 * M_PI : term.span;
    sum += term.factor * (term.profile ? term.profile->at((g - term.shift) / span).value : g);
  }
  return sum;
}

}  // namespace poise::test
