#include "motion/dyad_chain.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

namespace poise {
namespace {

/// A pin from the side of one of its bodies.
struct Pinned {
  PointRef own, other;
};

std::optional<Pinned> seen_from(const Joint& joint, int body) {
  if (joint.kind != Joint::Kind::pin) return std::nullopt;
  if (joint.a.body == body) return Pinned{joint.a, joint.b};
  if (joint.b.body == body) return Pinned{joint.b, joint.a};
  return std::nullopt;
}

// A pin of `body` to a placed one.
std::optional<Pinned> hold_of(const Scene& scene, int body, const std::vector<bool>& placed) {
  for (const Joint& joint : scene.joints) {
    const auto pin = seen_from(joint, body);
    if (pin && placed[pin->other.body]) return pin;
  }
  return std::nullopt;
}

std::optional<Dyad> next_dyad(const Scene& scene, const std::vector<bool>& placed) {
  for (const Joint& joint : scene.joints) {
    if (joint.kind != Joint::Kind::pin || placed[joint.a.body] || placed[joint.b.body]) continue;
    const auto first = hold_of(scene, joint.a.body, placed);
    const auto second = hold_of(scene, joint.b.body, placed);
    if (!first || !second) continue;
    return Dyad{joint.name, joint.a.body, joint.b.body, first->other, second->other,
                first->own, second->own,  joint.a,      joint.b};
  }
  return std::nullopt;
}

Vec2 along(Vec2 v) {
  const double length = norm(v);
  return length > 0.0 ? (1.0 / length) * v : Vec2{1.0, 0.0};
}

}  // namespace

DyadChain::DyadChain(const Scene& scene, int driver, const std::vector<int>& needed)
    : first_slot_{0}, placed_(scene.bodies.size(), false), driver_(driver) {
  for (const Body& body : scene.bodies) first_slot_.push_back(first_slot_.back() + body.points.size());
  placed_[0] = true;
  const auto pivot = hold_of(scene, driver, placed_);
  if (!pivot) {
    throw InputError(
        fmt::format("{}: body \"{}\": expected a pin to the ground, about which it is driven; drive another",
                    scene.file, scene.bodies[driver].name));
  }
  pivot_ = pivot->other;
  pivot_anchor_ = pivot->own;
  placed_[driver] = true;
  const auto missing = [&] {
    return std::find_if(needed.begin(), needed.end(), [&](int body) { return !placed_[body]; });
  };
  while (missing() != needed.end()) {
    const auto dyad = next_dyad(scene, placed_);
    if (!dyad) {
      throw InputError(
          fmt::format("{}: body \"{}\": expected to be reached from \"{}\" by dyads, two bodies pinned to "
                      "each other and each to one that is placed before; name another body",
                      scene.file, scene.bodies[*missing()].name, scene.bodies[driver].name));
    }
    placed_[dyad->first] = placed_[dyad->second] = true;
    dyads_.push_back(*dyad);
  }
}

double DyadChain::place(std::span<const Vec2> points, double angle, std::span<const int> signs, std::span<Pose> poses,
                        std::span<double> cosines) const {
  const auto local = [&](PointRef p) { return points[slot(p)]; };
  const auto turn_to = [&](int body, PointRef anchor, PointRef tip, Vec2 at, Vec2 towards) {
    Pose& pose = poses[body];
    pose.direction = along((towards - at) * conj(local(tip) - local(anchor)));
    pose.origin = at - local(anchor) * pose.direction;
  };
  poses[0] = {};
  poses[driver_].direction = unit(angle);
  poses[driver_].origin = local(pivot_) - local(pivot_anchor_) * poses[driver_].direction;
  double gap = 0.0;
  for (std::size_t i = 0; i < dyads_.size(); ++i) {
    const Dyad& d = dyads_[i];
    const Vec2 p = poses[d.first_known.body].world(local(d.first_known));
    const Vec2 r = poses[d.second_known.body].world(local(d.second_known));
    const double a = norm(local(d.first_tip) - local(d.first_anchor));
    const double b = norm(local(d.second_tip) - local(d.second_anchor));
    const double distance = norm(r - p);
    const double missing = std::max({0.0, distance - (a + b), std::abs(a - b) - distance});
    gap += missing / (a + b);
    cosines[i] = (a * a + b * b - distance * distance) / (2 * a * b);
    const double x = std::clamp((a * a - b * b + distance * distance) / (2 * distance), -a, a);
    const double y = std::sqrt(std::max(0.0, a * a - x * x));
    const Vec2 tip = p + Vec2{x, signs[i] * y} * along(r - p);
    turn_to(d.first, d.first_anchor, d.first_tip, p, tip);
    turn_to(d.second, d.second_anchor, d.second_tip, r, tip);
  }
  return gap;
}

}  // namespace poise
