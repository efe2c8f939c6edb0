#include "app/results/statics/check.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

Line verdict(const Mobility& mobility) {
  if (!mobility.assembled) return {.text = "Cannot be assembled: " + mobility.gap + ".", .tone = Tone::bad};
  if (mobility.freedoms == 0) {
    return {.text = "All loops close; no degree of freedom that carries a load.", .tone = Tone::doubtful};
  }
  return {
      .text = fmt::format("All loops close; {}.", count(mobility.freedoms, "degree of freedom", "degrees of freedom")),
      .tone = Tone::good};
}

void add_bodies(Group& group, const Scene& scene) {
  std::vector<std::string> names, points;
  std::vector<double> masses;
  bool any_mass = false;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    names.push_back(body.name);
    std::vector<std::string> named;
    for (const NamedPoint& p : body.points) named.push_back(p.name);
    points.push_back(fmt::format("{}", fmt::join(named, ", ")));
    masses.push_back(in_unit(body.mass, Quantity::mass, scene.units));
    any_mass = any_mass || body.mass > 0;
  }
  Table& table = group.table("bodies", "Bodies", Rows::list);
  table.words("name", "name", std::move(names));
  table.numbers("mass", "mass", unit_name(Quantity::mass, scene.units), std::move(masses)).shown = any_mass;
  table.words("points", "points", std::move(points));
}

void add_joints(Group& group, const Scene& scene) {
  std::vector<std::string> names, kinds, from, to;
  for (const Joint& joint : scene.joints) {
    names.push_back(joint.name);
    kinds.emplace_back(joint.traits().key);
    std::replace(kinds.back().begin(), kinds.back().end(), '_', ' ');
    from.push_back(scene.name_of(joint.a));
    to.push_back(scene.name_of(joint.b));
  }
  Table& table = group.table("joints", "Joints", Rows::list);
  table.words("name", "name", std::move(names));
  table.words("kind", "kind", std::move(kinds));
  table.words("from", "from", std::move(from));
  table.words("to", "to", std::move(to));
}

}  // namespace

Result check_result(const StaticModel& model, const Mobility& mobility, const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(mobility);
  Group& content = out.content;
  content.data("assembled", mobility.assembled);
  content.data("gap", mobility.gap);
  for (const auto& [key, number] :
       {std::pair{"moving_bodies", mobility.bodies}, std::pair{"moving_joints", mobility.joints},
        std::pair{"coordinates", mobility.coordinates}, std::pair{"closure_equations", mobility.closures},
        std::pair{"rank", mobility.rank}, std::pair{"degrees_of_freedom", mobility.freedoms},
        std::pair{"gruebler", mobility.gruebler}}) {
    content.data(key, number);
  }
  content.fact("mechanism", count(mobility.bodies, "moving body", "moving bodies") + ", " +
                                count(mobility.joints, "joint", "joints"));
  content.fact("model", fmt::format("{}, {} of rank {}", count(mobility.coordinates, "coordinate", "coordinates"),
                                    count(mobility.closures, "closure equation", "closure equations"), mobility.rank));
  content.fact("mobility",
               fmt::format("{}; counting bodies and joints (Gruebler) gives {}",
                           mobility.freedoms > 0 ? count(mobility.freedoms, "degree of freedom", "degrees of freedom")
                                                 : "no degree of freedom that carries a load",
                           mobility.gruebler),
               mobility.freedoms > 0 ? Tone::plain : Tone::doubtful);
  content.fact("constraints",
               mobility.redundant.empty() ? "no constraint repeats or contradicts another"
               : mobility.assembled       ? "some constraints are redundant"
                                          : "some constraints are redundant or conflict",
               mobility.redundant.empty() ? Tone::plain : Tone::doubtful);
  content.list("redundant_joints", mobility.assembled ? "Redundant joints" : "Redundant or conflicting joints",
               mobility.redundant);
  add_bodies(content, model.scene());
  add_joints(content, model.scene());
  content.list("kept", "The model keeps", mobility.kept);
  content.list("dropped", "The model drops", mobility.dropped);
  return out;
}

}  // namespace poise::app
