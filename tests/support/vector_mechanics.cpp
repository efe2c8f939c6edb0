#include "tests/support/vector_mechanics.hpp"

#include <algorithm>

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
  for (const Spring& spring : scene.springs) {
    const double stretch = norm(world(scene, spring.b, poses) - world(scene, spring.a, poses)) - spring.free_length;
    if (spring.acts == Spring::Acts::tension && stretch < 0) continue;
    if (spring.acts == Spring::Acts::compression && stretch > 0) continue;
    v += spring.stiffness / 2 * stretch * stretch;
  }
  for (const TorsionSpring& spring : scene.torsion_springs) {
    const double wind = poses[spring.b].angle - poses[spring.a].angle - spring.free_angle;
    v += spring.stiffness / 2 * wind * wind;
  }
  return v;
}

Vec2 gap(const Scene& scene, int joint, double travel, const Poses& poses) {
  const Joint& j = scene.joints[joint];
  const Vec2 apart = world(scene, j.b, poses) - world(scene, j.a, poses);
  if (j.has_travel()) return apart - travel * (j.axis * unit(poses[j.a.body].angle));
  if (j.kind != Joint::Kind::bar) return apart;
  const auto bars_before = std::count_if(scene.joints.begin(), scene.joints.begin() + joint,
                                         [](const Joint& other) { return other.kind == Joint::Kind::bar; });
  const BodyPose<double>& bar = poses[scene.bodies.size() + static_cast<std::size_t>(bars_before)];
  return apart - j.length * unit(bar.angle);
}

double stop_value(const Scene& scene, const Stop& stop, const Poses& poses) {
  if (stop.kind == Stop::Kind::angle) return poses[stop.body_b].angle - poses[stop.body_a].angle;
  if (stop.kind == Stop::Kind::distance) return norm(world(scene, stop.b, poses) - world(scene, stop.a, poses));
  const Joint& joint = scene.joints[stop.joint];
  return dot(joint.axis * unit(poses[joint.a.body].angle), world(scene, joint.b, poses) - world(scene, joint.a, poses));
}

}  // namespace poise::test
