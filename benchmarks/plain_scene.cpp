#include "benchmarks/plain_scene.hpp"

#include <cmath>

namespace poise::benchmarks {
namespace {

PlainMechanism::Vector plain(Vec2 v) { return {v.x, v.y}; }

PlainMechanism::Joint plain(const Scene& scene, const Joint& joint) {
  if (joint.kind != Joint::Kind::pin && joint.kind != Joint::Kind::slide) {
    throw InputError(joint.name + ": only pins and slides are translated");
  }
  return {joint.kind == Joint::Kind::slide,
          {joint.a.body, plain(scene.local(joint.a))},
          {joint.b.body, plain(scene.local(joint.b))},
          std::atan2(joint.axis.y, joint.axis.x),
          joint.angle};
}

}  // namespace

PlainMechanism plain(const Scene& scene) {
  const auto place = [&scene](PointRef p) -> PlainMechanism::Place { return {p.body, plain(scene.local(p))}; };
  PlainMechanism out;
  out.gravity = plain(scene.gravity);
  for (const Body& b : scene.bodies) out.bodies.push_back({b.mass, b.inertia, plain(b.center)});
  for (const Joint& joint : scene.joints) out.joints.push_back(plain(scene, joint));
  for (const Element& element : scene.elements) {
    if (!stores_energy(element.law)) continue;
    const auto* s = std::get_if<LinearSpring>(&element.law);
    if (s == nullptr || element.on.kind != Measure::Kind::distance) {
      throw InputError(element.name + ": only springs between two points are translated");
    }
    out.springs.push_back({place(element.on.a), place(element.on.b), s->stiffness, s->free_length,
                           s->acts != LinearSpring::Acts::compression, s->acts != LinearSpring::Acts::tension});
  }
  for (const Force& f : scene.forces) {
    if (f.follows >= 0) throw InputError(f.name + ": it has no potential");
    out.forces.push_back({place(f.at), plain(f.vector)});
  }
  for (const Torque& t : scene.torques) out.torques.push_back({t.body, t.value});
  for (const Stop& s : scene.stops) {
    if (s.on.kind != Measure::Kind::angle) throw InputError(s.name + ": only stops of angles are translated");
    out.stops.push_back({s.on.body_a, s.on.body_b, s.min, s.max});
  }
  return out;
}

PlainPose plain_pose(const StaticModel& model, const std::vector<double>& x) {
  PlainPose pose;
  for (const BodyPose<double>& place : model.poses(x)) pose.angle.push_back(place.angle);
  for (const int travel : model.layout().travel) pose.travel.push_back(travel < 0 ? 0.0 : x.at(travel));
  return pose;
}

std::vector<double> coordinates(const StaticModel& model, const PlainPose& pose) {
  const Layout& layout = model.layout();
  std::vector<double> x = model.start();
  for (const Link& link : layout.links) {
    if (link.body > 0 && link.frame >= 0 && link.frame < layout.kept) x[link.frame] = pose.angle[link.body] - link.turn;
  }
  for (std::size_t j = 0; j < layout.travel.size(); ++j) {
    if (layout.travel[j] >= 0 && layout.travel[j] < layout.kept) x[layout.travel[j]] = pose.travel[j];
  }
  return x;
}

}  // namespace poise::benchmarks
