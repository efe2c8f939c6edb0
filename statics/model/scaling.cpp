#include "statics/model/scaling.hpp"

#include <algorithm>
#include <cmath>

namespace poise {
namespace {

double power_of_two_near(double x) { return x > 0 && std::isfinite(x) ? std::exp2(std::round(std::log2(x))) : 1.0; }

// Force of an element whose measure changes by one length, or by one radian.
double force_of(const Element& element, double length) {
  return element.on.is_angle() ? force_scale(element.law, 1.0) / length : force_scale(element.law, length);
}

}  // namespace

Scales choose_scales(const Scene& scene, double size) {
  Scales scales;
  scales.length = power_of_two_near(size);
  double load = 0.0;
  for (const Body& b : scene.bodies) load += b.mass * norm(scene.gravity);
  for (const Force& f : scene.forces) load += scene.size_of(f);
  for (const Torque& t : scene.torques) load += std::abs(t.value) / scales.length;
  if (load == 0.0) {
    for (const Element& e : scene.elements) load = std::max(load, force_of(e, scales.length));
  }
  scales.force = power_of_two_near(load);
  return scales;
}

}  // namespace poise
