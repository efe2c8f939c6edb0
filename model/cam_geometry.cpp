#include "model/cam_geometry.hpp"

#include <tuple>
#include <utility>

namespace poise {
namespace {

/// The points of `base` and of `body` at which a pin joins them; nothing where none does.
std::optional<std::pair<PointRef, PointRef>> pin_of(const Scene& scene, int base, int body) {
  for (const Joint& joint : scene.joints) {
    if (joint.kind != Joint::Kind::pin) continue;
    if (joint.a.body == base && joint.b.body == body) return std::pair(joint.a, joint.b);
    if (joint.b.body == base && joint.a.body == body) return std::pair(joint.b, joint.a);
  }
  return std::nullopt;
}

/// The other one of the two bodies of an angle; -1 where `base` is none of them.
int other_of(const Measure& angle, int base) {
  return angle.body_a == base ? angle.body_b : angle.body_b == base ? angle.body_a : -1;
}

}  // namespace

std::optional<CamGeometry> cam_geometry(const Scene& scene, const Stop& stop) {
  if (stop.table != "cam") return std::nullopt;
  const Measure& follower = stop.on.terms[0].measure;
  const Measure& cam = stop.on.terms[1].measure;
  const auto on_base = [&](int base) -> std::optional<CamGeometry> {
    CamGeometry out;
    const int body = other_of(cam, base);
    const auto axis = body < 0 ? std::nullopt : pin_of(scene, base, body);
    if (!axis) return std::nullopt;
    std::tie(out.axis, out.on_cam) = *axis;
    out.sense = cam.body_a == base ? 1.0 : -1.0;
    if (follower.kind == Measure::Kind::travel) {
      const Joint& slide = scene.joints[static_cast<std::size_t>(follower.joint)];
      out.roller = stop.roller.value_or(slide.b);
      // What a pin carries in a slot may turn about it.
      const bool is_on_it = slide.keeps_angle() ? out.roller.body == slide.b.body : out.roller == slide.b;
      if (slide.a.body != base || !is_on_it || slide.b.body == body) return std::nullopt;
      out.slide = follower.joint;
      return out;
    }
    const int arm = other_of(follower, base);
    const auto pivot = arm < 0 || arm == body ? std::nullopt : pin_of(scene, base, arm);
    if (!pivot || !stop.roller || stop.roller->body != arm) return std::nullopt;
    out.roller = *stop.roller;
    std::tie(out.pivot, out.on_follower) = *pivot;
    out.turn_sense = follower.body_a == base ? 1.0 : -1.0;
    return out;
  };
  if (follower.kind != Measure::Kind::travel && follower.kind != Measure::Kind::angle) return std::nullopt;
  const std::optional<CamGeometry> out = on_base(cam.body_a);
  return out ? out : on_base(cam.body_b);
}

}  // namespace poise
