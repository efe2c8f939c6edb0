#include "statics/scaling.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

double power_of_two_near(double x) { return x > 0 && std::isfinite(x) ? std::exp2(std::round(std::log2(x))) : 1.0; }

}  // namespace

Scales choose_scales(const Scene& scene, double size) {
  Scales scales;
  scales.length = power_of_two_near(size);
  double load = 0.0;
  for (const Body& b : scene.bodies) load += b.mass * norm(scene.gravity);
  for (const Force& f : scene.forces) load += norm(f.vector);
  for (const Torque& t : scene.torques) load += std::abs(t.value) / scales.length;
  if (load == 0.0) {
    for (const Spring& s : scene.springs) load = std::max(load, s.stiffness * scales.length);
    for (const TorsionSpring& s : scene.torsion_springs) load = std::max(load, s.stiffness / scales.length);
  }
  scales.force = power_of_two_near(load);
  return scales;
}

Scene scaled(const Scene& scene, const Scales& scales) {
  Scene out = scene;
  const double per_length = scales.per_length();
  const double per_force = scales.per_force();
  const double per_energy = scales.per_energy();
  out.gravity = per_length * out.gravity;
  for (Body& b : out.bodies) {
    for (NamedPoint& p : b.points) p.at = per_length * p.at;
    b.center = per_length * b.center;
    b.mass *= scales.length * per_force;
    b.inertia *= per_energy;
  }
  for (Joint& j : out.joints) j.length *= per_length;
  for (Spring& s : out.springs) {
    s.stiffness *= scales.per_stiffness();
    s.free_length *= per_length;
  }
  for (TorsionSpring& s : out.torsion_springs) s.stiffness *= per_energy;
  for (Damper& d : out.dampers) d.coefficient *= scales.length * per_force;
  for (TorsionDamper& d : out.torsion_dampers) d.coefficient *= per_energy;
  for (Friction& f : out.frictions) f.torque *= per_energy;
  for (Drive& d : out.drives) {
    if (d.kind == Drive::Kind::angle) continue;
    if (d.start) *d.start *= per_length;
    d.rate *= per_length;
    d.acceleration *= per_length;
    d.amplitude *= per_length;
  }
  for (Force& f : out.forces) f.vector = per_force * f.vector;
  for (Torque& t : out.torques) t.value *= per_energy;
  for (Stop& s : out.stops) {
    if (s.kind == Stop::Kind::angle) continue;
    s.min *= per_length;
    s.max *= per_length;
  }
  for (auto& travel : out.start.travel) {
    if (travel) *travel *= per_length;
  }
  for (auto& position : out.start.position) {
    if (position) *position = per_length * *position;
  }
  return out;
}

}  // namespace poise
