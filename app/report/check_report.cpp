#include <algorithm>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/report/report.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

std::string body_section(const StaticModel& model, const Palette& palette) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, points;
  std::vector<double> masses;
  bool any_mass = false;
  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    names.push_back(body.name);
    std::string named;
    for (const NamedPoint& p : body.points) named += (named.empty() ? "" : ", ") + p.name;
    points.push_back(named);
    masses.push_back(in_unit(body.mass, Quantity::mass, scene.units));
    any_mass = any_mass || body.mass > 0;
  }
  Table table;
  table.add_text_column("name", names);
  if (any_mass) table.add_number_column(with_unit("mass", Quantity::mass, scene.units), aligned(masses, force_digits));
  table.add_text_column("points", points);
  return section("Bodies", table.print(palette), palette);
}

// "pin in slot".
std::string in_words(const Joint& joint) {
  std::string words(joint.traits().key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

std::string joint_section(const Scene& scene, const Palette& palette) {
  std::vector<std::string> names, kinds, from, to;
  for (const Joint& joint : scene.joints) {
    names.push_back(joint.name);
    kinds.emplace_back(in_words(joint));
    from.push_back(scene.name_of(joint.a));
    to.push_back(scene.name_of(joint.b));
  }
  Table table;
  table.add_text_column("name", names);
  table.add_text_column("kind", kinds);
  table.add_text_column("from", from);
  table.add_text_column("to", to);
  return section("Joints", table.print(palette), palette);
}

std::string constraints(const Mobility& mobility, const Palette& palette) {
  if (mobility.redundant.empty()) return "none repeats or contradicts another";
  return palette.paint(
      Tone::doubtful, mobility.assembled ? "some repeat what others hold already" : "some repeat or contradict others");
}

}  // namespace

std::string check_report(const StaticModel& model, const Mobility& mobility, const Palette& palette) {
  std::string out = heading(model, palette);
  out += fact("mechanism",
              count(mobility.bodies, "moving body", "moving bodies") + ", " + count(mobility.joints, "joint", "joints"),
              palette);
  out += fact("model",
              fmt::format("{}, {} of rank {}", count(mobility.coordinates, "coordinate", "coordinates"),
                          count(mobility.closures, "closure equation", "closure equations"), mobility.rank),
              palette);
  out += fact("mobility",
              fmt::format("{}; counting bodies and joints gives {}",
                          mobility.freedoms > 0 ? count(mobility.freedoms, "freedom", "freedoms")
                                                : palette.paint(Tone::doubtful, "none that bears a load"),
                          mobility.gruebler),
              palette);
  out += fact("assembly",
              mobility.assembled ? palette.paint(Tone::good, "all loops close from the start")
                                 : palette.paint(Tone::bad, mobility.gap),
              palette);
  out += fact("constraints", constraints(mobility, palette), palette);
  out += list_section(mobility.assembled ? "Redundant joints" : "Redundant or conflicting joints", mobility.redundant,
                      palette);
  out += body_section(model, palette);
  out += joint_section(model.scene(), palette);
  out += list_section("The model keeps", mobility.kept, palette);
  out += list_section("The model drops", mobility.dropped, palette);
  return out;
}

}  // namespace poise::app
