#include "statics/forces_on_bodies.hpp"

#include <algorithm>

#include "statics/body_measures.hpp"
#include "statics/free_body_equations.hpp"

namespace poise {
namespace {

/// Adds forces of one source; those on one body at one point are one.
class Source {
 public:
  Source(std::string_view kind, const std::string& name, std::vector<SourcedForce>& out)
      : kind_(kind), name_(name), out_(out), first_(out.size()) {}

  void act(const BodyForce& on) {
    const auto found =
        std::find_if(out_.begin() + static_cast<std::ptrdiff_t>(first_), out_.end(),
                     [&](const SourcedForce& one) { return one.on.body == on.body && one.on.at == on.at; });
    if (found == out_.end()) {
      out_.push_back({std::string(kind_), name_, on});
      return;
    }
    found->on.force += on.force;
    found->on.moment += on.moment;
  }

 private:
  std::string_view kind_;
  const std::string& name_;
  std::vector<SourcedForce>& out_;
  std::size_t first_;
};

}  // namespace

void add_effort(const Scene& scene, const std::vector<BodyPose<double>>& poses, const Measure& on, double effort,
                std::string_view kind, const std::string& name, std::vector<SourcedForce>& out) {
  Source source(kind, name, out);
  for (const UnitEffort& unit : unit_efforts(scene, on, poses)) {
    source.act({.body = unit.body_b, .at = unit.b, .force = effort * unit.force, .moment = effort * unit.moment});
    source.act({.body = unit.body_a, .at = unit.a, .force = -effort * unit.force, .moment = -effort * unit.moment});
  }
}

std::vector<SourcedForce> forces_on_bodies(const Scene& scene, const std::vector<BodyPose<double>>& poses,
                                           const std::vector<double>& element_forces,
                                           const std::vector<Reaction>& reactions) {
  std::vector<SourcedForce> out;
  FreeBodyEquations(scene, poses, 1.0)
      .push_named_loads(
          [&](std::string_view kind, const std::string& name, int body, Vec2 at, Vec2 force, double moment) {
            out.push_back({std::string(kind), name, {.body = body, .at = at, .force = force, .moment = moment}});
          });
  for (std::size_t e = 0; e < scene.elements.size(); ++e) {
    const Element& element = scene.elements[e];
    add_effort(scene, poses, element.on, -element_forces[e], element.table, element.name, out);
  }
  for (const Reaction& r : reactions) {
    Source source(r.kind, r.name, out);
    for (const BodyForce& part : r.parts) source.act(part);
    if (!r.parts.empty()) continue;
    const BodyForce on_b{r.body_b, r.at, r.force, r.moment, r.radius, r.moment_radius};
    source.act(on_b);
    source.act({r.body_a, r.at, -r.force, -r.moment, r.radius, r.moment_radius});
  }
  return out;
}

}  // namespace poise
