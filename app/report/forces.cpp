#include <cmath>
#include <limits>
#include <unordered_map>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"

namespace poise::app {
inline namespace replaced {
namespace {

/// Name of the body on which a measure's force acts, the opposite acting on the first; a sum has several.
std::string second_body(const Scene& scene, const Measure& on) {
  switch (on.kind) {
    case Measure::Kind::angle:
      return scene.bodies[on.body_b].name;
    case Measure::Kind::travel:
      return scene.bodies[scene.joints[on.joint].b.body].name;
    case Measure::Kind::distance:
    case Measure::Kind::x:
    case Measure::Kind::y:
      return scene.bodies[on.b.body].name;
    case Measure::Kind::sum:
      break;
  }
  return "(sum)";
}

std::string line_spring_section(const StaticModel& model, const Readings& readings, const Palette& palette) {
  const Scene& scene = model.scene();
  std::vector<std::string> names;
  std::vector<Cell> notes;
  std::vector<double> lengths, forces;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) || element.on.is_angle()) continue;
    const ElementReading& reading = readings.elements[i];
    names.push_back(element.name);
    lengths.push_back(reading.value);
    forces.push_back(reading.force);
    const bool pushes = reading.force < -rounding_of(model, Quantity::force);
    const bool pulls = reading.force > rounding_of(model, Quantity::force);
    notes.push_back({reading.slack ? "slack" : pushes ? "pushes" : pulls ? "pulls" : "at rest", Tone::faint});
  }
  Table table;
  table.add_text_column("name", names);
  table.add_number_column(with_unit("length", Quantity::length, scene.units),
                          aligned(in_units(model, Quantity::length, lengths), force_digits));
  table.add_number_column(with_unit("force", Quantity::force, scene.units),
                          aligned(in_units(model, Quantity::force, forces), force_digits));
  table.add_text_column("", notes);
  return section("Springs, tension positive", table.print(palette), palette);
}

std::string torsion_spring_section(const StaticModel& model, const Readings& readings, const Palette& palette) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, bodies;
  std::vector<double> moments;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) || !element.on.is_angle()) continue;
    names.push_back(element.name);
    bodies.push_back(second_body(scene, element.on));
    moments.push_back(-readings.elements[i].force);
  }
  Table table;
  table.add_text_column("name", names);
  table.add_text_column("on", bodies);
  table.add_number_column(with_unit("moment", Quantity::moment, scene.units),
                          aligned(in_units(model, Quantity::moment, moments), force_digits));
  return section("Torsion springs, moment on the named body", table.print(palette), palette);
}

/// The body that a reaction acts on, by the name of its joint or stop.
class ReactionBodies {
 public:
  explicit ReactionBodies(const Scene& scene) {
    for (const Joint& joint : scene.joints) joints_.emplace(joint.name, scene.bodies[joint.b.body].name);
    for (const Stop& stop : scene.stops) stops_.emplace(stop.name, second_body(scene, stop.on));
  }
  const std::string& of(const Reaction& reaction) const {
    return (reaction.kind == "stop" ? stops_ : joints_).at(reaction.name);
  }

 private:
  std::unordered_map<std::string, std::string> joints_, stops_;
};

}  // namespace

std::string spring_sections(const StaticModel& model, const Readings& readings, const Palette& palette) {
  return line_spring_section(model, readings, palette) + torsion_spring_section(model, readings, palette);
}

std::string reaction_section(const ScaledModel& model, const std::vector<Reaction>& reactions, int redundancy,
                             const Palette& palette) {
  const Units& units = model.scene().units;
  const ReactionBodies bodies(model.scene());
  std::vector<std::string> names, kinds, on;
  std::vector<Cell> notes;
  std::vector<double> forces, moments, axials;  // forces: x, y and magnitude of each in turn
  bool any_moment = false;
  bool any_axial = false;
  for (const Reaction& r : reactions) {
    names.push_back(r.name);
    kinds.push_back(r.kind);
    on.push_back(bodies.of(r));
    forces.insert(forces.end(), {r.force.x, r.force.y, norm(r.force)});
    moments.push_back(r.moment);
    any_moment = any_moment || std::abs(r.moment) > rounding_of(model, Quantity::moment);
    const bool is_axial = r.kind == "bar" || r.axial != 0.0;
    axials.push_back(is_axial ? r.axial : std::numeric_limits<double>::quiet_NaN());
    any_axial = any_axial || is_axial;
    notes.push_back({r.determined ? "" : "undetermined", Tone::doubtful});
  }
  const std::vector<std::string> texts = aligned(in_units(model, Quantity::force, forces), force_digits);
  const auto every_third = [&](std::size_t first) {
    std::vector<std::string> part;
    for (std::size_t i = first; i < texts.size(); i += 3) part.push_back(texts[i]);
    return part;
  };
  Table table;
  table.add_text_column("joint", names);
  table.add_text_column("kind", kinds);
  table.add_text_column("on", on);
  table.add_number_column(with_unit("Fx", Quantity::force, units), every_third(0));
  table.add_number_column(with_unit("Fy", Quantity::force, units), every_third(1));
  table.add_number_column(with_unit("|F|", Quantity::force, units), every_third(2));
  if (any_moment) {
    table.add_number_column(with_unit("moment", Quantity::moment, units),
                            aligned(in_units(model, Quantity::moment, moments), force_digits));
  }
  if (any_axial) {
    table.add_number_column(with_unit("tension", Quantity::force, units),
                            aligned(in_units(model, Quantity::force, axials), force_digits));
  }
  table.add_text_column("", notes);
  std::string body = table.print(palette);
  if (redundancy > 0) {
    const std::string states = count(redundancy, "state of self-stress", "states of self-stress");
    body += palette.paint(Tone::doubtful, "  " + states +
                                              ": statics leaves the marked reactions open; shown are those "
                                              "of minimum norm.") +
            "\n";
  }
  return section("Reactions on the named body, along world axes", body, palette);
}

}  // namespace replaced
}  // namespace poise::app
