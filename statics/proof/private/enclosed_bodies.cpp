#include "statics/proof/private/enclosed_bodies.hpp"

#include <cstddef>

#include "statics/model/ball_mechanism.hpp"

namespace poise {

std::vector<PlacedBody<Ball>> enclosed_bodies(const StaticModel& model, const Certificate& certificate) {
  std::vector<Ball> q;
  for (std::size_t i = 0; i < certificate.x.size(); ++i) {
    q.push_back(certificate.rest.empty()
                    ? Ball(certificate.x[i]).widened(certificate.radius)
                    : (Ball(certificate.x[i]) + Ball(certificate.rest[i])).widened(certificate.rest_radius));
  }
  std::vector<BodyPose<Ball>> poses = model.balls().exact.poses(q.data(), model.layout().anchor);
  std::vector<PlacedBody<Ball>> out;
  out.reserve(poses.size());
  const Ball unit_length(model.scales().length);
  // Every arm on the way to a body may be open in both components.
  std::size_t arms = 0;
  for (const Link& link : model.layout().links) arms += 1 + link.arms.size();
  const double open = (Ball(2.0 * static_cast<double>(arms)) * Ball(certificate.gap)).greatest();
  for (BodyPose<Ball>& pose : poses) {
    pose.origin = {unit_length * pose.origin.x.widened(open), unit_length * pose.origin.y.widened(open)};
    out.emplace_back(pose);
  }
  return out;
}

}  // namespace poise
