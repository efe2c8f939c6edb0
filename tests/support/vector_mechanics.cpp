#include "tests/support/vector_mechanics.hpp"

#include <algorithm>
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
    if (const auto* constant = std::get_if<ConstantForce>(&element.law)) v += constant->force * g;
    const auto* spring = std::get_if<LinearSpring>(&element.law);
    if (spring == nullptr) continue;
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
    case Measure::Kind::sum:
      break;
  }
  double sum = 0.0;
  for (const Measure::Term& term : measure.terms) sum += term.factor * measured(scene, term.measure, poses);
  return sum;
}

}  // namespace poise::test
