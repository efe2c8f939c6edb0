#include "statics/bodies/forces_on_bodies.hpp"

#include <algorithm>

#include "statics/bodies/body_forces.hpp"

namespace poise {
namespace {

void add_source(std::string_view kind, const std::string& name, const std::vector<BodyForce>& parts,
                std::vector<SourcedForce>& out) {
  for (const BodyForce& part : parts) out.push_back({std::string(kind), name, part});
}

}  // namespace

void add_at_place(const BodyForce& on, std::vector<BodyForce>& parts) {
  const auto part = std::find_if(parts.begin(), parts.end(),
                                 [&](const BodyForce& one) { return one.body == on.body && one.at == on.at; });
  if (part == parts.end()) {
    parts.push_back(on);
    return;
  }
  part->force += on.force;
  part->moment += on.moment;
}

void add_effort(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Measure& on, double effort,
                std::string_view kind, const std::string& name, std::vector<SourcedForce>& out) {
  std::vector<BodyForce> parts;
  for (const UnitEffort& unit : unit_efforts(scene, on, poses)) {
    const Vec2 force = effort * unit.force;
    const double moment = effort * unit.moment;
    add_at_place({.body = unit.body_b, .at = unit.b, .force = force, .moment = moment}, parts);
    add_at_place({.body = unit.body_a, .at = unit.a, .force = -force, .moment = -moment}, parts);
  }
  add_source(kind, name, parts, out);
}

std::vector<SourcedForce> forces_on_bodies(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                           const std::vector<double>& element_forces,
                                           const std::vector<Reaction>& reactions) {
  std::vector<SourcedForce> out;
  BodyForces(scene, poses)
      .push_loads([&](std::string_view kind, const std::string& name, int body, Vec2 at, Vec2 force, double moment) {
        out.push_back({std::string(kind), name, {.body = body, .at = at, .force = force, .moment = moment}});
      });
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    add_effort(scene, poses, element.on, -element_forces[e], element.table, element.name, out);
  }
  for (const Reaction& r : reactions) {
    std::vector<BodyForce> parts = r.parts;
    if (parts.empty()) {
      parts = {{r.body_b, r.at, r.force, r.moment, r.radius, r.moment_radius},
               {r.body_a, r.at, -r.force, -r.moment, r.radius, r.moment_radius}};
    }
    add_source(r.kind, r.name, parts, out);
  }
  return out;
}

}  // namespace poise
