#include "statics/cam_contact.hpp"

#include <algorithm>
#include <cmath>

#include "statics/body_measures.hpp"

namespace poise {
namespace {

const Reaction* reaction_of(const Stop& stop, const std::vector<Reaction>& reactions) {
  const auto found = std::find_if(reactions.begin(), reactions.end(),
                                  [&](const Reaction& r) { return r.of_stop && r.name == stop.name; });
  return found == reactions.end() ? nullptr : &*found;
}

/// Q of a cam, from its reaction.
double effort_of(const Stop& stop, const Reaction* reaction) {
  if (reaction == nullptr) return 0.0;
  return stop.on.is_angle() ? reaction->moment : -reaction->axial;
}

/// In a pose in which the roller is on the pitch curve.
std::optional<CamContact> contact_of(const Scene& scene, const Stop& stop, const CamGeometry& cam,
                                     const std::vector<BodyPose<double>>& poses, double effort) {
  const auto world = [&](PointRef p) { return poses[static_cast<std::size_t>(p.body)].world(scene.local(p)); };
  const Measure::Term& term = stop.on.terms[1];
  const double u = (value_of(scene, term.measure, poses) - term.shift) / (2 * M_PI);
  const double slope = -cam.sense * term.factor * term.profile->at(u).first / (2 * M_PI);
  const Vec2 r = world(cam.roller) - world(cam.axis);
  Vec2 along{};
  double lever = 1.0;
  if (cam.slide >= 0) {
    const Joint& slide = scene.joints[static_cast<std::size_t>(cam.slide)];
    along = slide.direction() * poses[static_cast<std::size_t>(slide.a.body)].direction();
  } else {
    const Vec2 arm = world(cam.roller) - world(cam.pivot);
    lever = norm(arm);
    if (lever == 0.0) return std::nullopt;
    along = (cam.turn_sense / lever) * quarter_turn(arm);
  }
  // For each radian by which the cam turns the roller moves against it by l g' t - quarter_turn(r).
  const double rise = lever * slope - cross(r, along), across = dot(r, along);
  constexpr double rounding = 1e-12;
  if (std::abs(across) <= rounding * (norm(r) + std::abs(lever * slope))) return std::nullopt;
  const double tangent = rise / across;
  const double force = effort / lever;
  return CamContact{std::atan(tangent), force * std::hypot(1.0, tangent), force * tangent};
}

}  // namespace

std::vector<CamReading> cam_readings(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                     const std::vector<Reaction>& reactions) {
  std::vector<CamReading> out;
  for (const Stop& stop : scene.stops) {
    const std::optional<CamGeometry> cam = cam_geometry(scene, stop);
    if (!cam) continue;
    const Reaction* const reaction = reaction_of(stop, reactions);
    out.push_back({stop.name, std::nullopt});
    if (stop.holds() || reaction != nullptr) {
      out.back().contact = contact_of(scene, stop, *cam, poses, effort_of(stop, reaction));
    }
  }
  return out;
}

}  // namespace poise
