#include "statics/proof/enclosed_values.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "statics/bodies/ball_measures.hpp"
#include "statics/bodies/contact_loads.hpp"
#include "statics/model/ball_mechanism.hpp"
#include "statics/proof/private/enclosed_bodies.hpp"

namespace poise {
namespace {

// Distances of a contact's numbers from all that the bodies at these places and the effort leave open.
CamContact radii_of(const CamContact& shown, const CamPush<Ball>& push, const Ball& effort) {
  const auto radius = [](const Ball& ball, double value) { return (ball - Ball(value)).greatest(); };
  const Ball force = effort / push.lever;
  return {radius(angle_of(Ball(1), push.tangent), shown.pressure_angle),
          radius(force * hypot(Ball(1), push.tangent), shown.normal), radius(force * push.tangent, shown.side)};
}

std::vector<CamContact> enclose_cams(const StaticModel& model, const Certificate& certificate,
                                     const std::vector<Reaction>& reactions) {
  const Scene& scene = model.scene();
  // Most scenes have no cam, and then the places of their bodies are not needed.
  const auto is_cam = [&](const Stop& stop) { return cam_geometry(scene, stop).has_value(); };
  if (std::none_of(scene.stops.begin(), scene.stops.end(), is_cam)) return {};
  const std::vector<CamReading> cams = cam_readings(scene, model.poses(certificate.x), reactions);
  const std::vector<PlacedBody<Ball>> bodies = enclosed_bodies(model, certificate);
  std::vector<CamContact> out;
  for (std::size_t s = 0; s < scene.stops.size(); ++s) {
    const Stop& stop = scene.stops[s];
    const std::optional<CamGeometry> cam = cam_geometry(scene, stop);
    if (!cam) continue;
    const std::optional<CamContact>& shown = cams[out.size()].contact;
    out.emplace_back();
    if (!shown) continue;
    const Reaction* const reaction = reaction_of_stop(reactions, s);
    Ball effort(0);
    if (reaction != nullptr) {
      effort =
          Ball(effort_of(stop, *reaction)).widened(stop.on.is_angle() ? reaction->moment_radius : reaction->radius);
    }
    out.back() = radii_of(*shown, *cam_push(BodyForces(scene, bodies), static_cast<int>(s), *cam), effort);
  }
  return out;
}

}  // namespace

ValueRadii enclose_values(const StaticModel& model, const Certificate& certificate,
                          const std::vector<Reaction>& reactions) {
  const Mechanism<double>& m = model.mechanism();
  const std::vector<double>& x = certificate.x;
  std::vector<Planar<double>> pose(m.pose_size());
  std::vector<double> shown(m.constraints());
  m.place(x.data(), pose.data());
  m.constraint(x.data(), pose.data(), shown.data());
  const Mechanism<Ball>& exact = model.balls().exact;
  std::vector<Ball> q;
  for (const double value : x) q.push_back(Ball(value).widened(certificate.radius));
  std::vector<Planar<Ball>> places(exact.pose_size());
  std::vector<Ball> enclosed(exact.constraints());
  exact.place(q.data(), places.data());
  exact.constraint(q.data(), places.data(), enclosed.data());
  const auto radius = [](const Ball& ball, double value) {
    const double greatest = (ball - Ball(value)).greatest();
    return std::isfinite(greatest) ? greatest : 0.0;
  };
  ValueRadii out;
  out.energy = radius(exact.energy(q.data(), places.data()), m.energy(x.data(), pose.data())) * model.scales().energy();
  for (int s = 0; s < m.stops(); ++s) {
    const auto row = static_cast<std::size_t>(m.stop_row(s));
    const double unit = model.scene().stops[static_cast<std::size_t>(s)].on.is_angle() ? 1.0 : model.scales().length;
    out.stops.push_back(radius(enclosed[row], shown[row]) * unit);
  }
  out.cams = enclose_cams(model, certificate, reactions);
  return out;
}

}  // namespace poise
