#include "statics/model/cam_contact.hpp"

#include <cmath>
#include <cstddef>

#include "statics/bodies/contact_loads.hpp"

namespace poise {
namespace {

/// In a pose in which the roller is on the pitch curve.
std::optional<CamContact> contact_of(const Scene& scene, std::size_t stop, const CamGeometry& cam,
                                     const std::vector<BodyPose<double>>& poses, double effort) {
  const std::optional<CamPush<double>> push = cam_push(BodyForces(scene, poses), static_cast<int>(stop), cam);
  if (!push) return std::nullopt;
  const double force = effort / push->lever;
  return CamContact{std::atan(push->tangent), force * std::hypot(1.0, push->tangent), force * push->tangent};
}

}  // namespace

std::vector<CamReading> cam_readings(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                     const std::vector<Reaction>& reactions) {
  std::vector<CamReading> out;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    const std::optional<CamGeometry> cam = cam_geometry(scene, stop);
    if (!cam) continue;
    const Reaction* const reaction = reaction_of_stop(reactions, s);
    out.push_back({stop.name, std::nullopt});
    if (stop.holds() || reaction != nullptr) {
      out.back().contact = contact_of(scene, s, *cam, poses, reaction ? effort_of(stop, *reaction) : 0.0);
    }
  }
  return out;
}

}  // namespace poise
