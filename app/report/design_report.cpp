#include "app/report/design_report.hpp"

#include <numbers>

#include <fmt/format.h>

#include "app/json_parts.hpp"
#include "app/quantity.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

constexpr int digits = 6;
constexpr double degree = std::numbers::pi / 180;

std::string in_length(double si, const Units& units) {
  return significant(in_unit(si, Quantity::length, units), digits) + " " + units.length_name;
}

std::string in_degrees(double si) { return significant(si / degree, digits) + " deg"; }

std::string verdict(const DesignResult& result, const DesignCheck& check, double microseconds, const Palette& palette) {
  const std::string effort =
      fmt::format("{}, {}, {}", count(result.starts, "random start", "random starts"),
                  count(static_cast<int>(result.evaluations), "candidate", "candidates"), duration(microseconds));
  if (result.values.empty()) return palette.paint(Tone::bad, "Nothing was tried: " + effort) + "\n";
  if (!result.met) {
    return palette.paint(Tone::bad, "No dimensions meet all goals yet; these come nearest") + " (" + effort + ")\n";
  }
  if (!check.met) return palette.paint(Tone::bad, "Not confirmed: " + check.why) + " (" + effort + ")\n";
  return palette.paint(Tone::good, "Dimensions that meet all goals, confirmed by the general kinematics") + " (" +
         effort + ")\n";
}

std::string goal_section(const DesignProblem& problem, const DesignFacts& facts, const Palette& palette) {
  const Units& units = problem.scene.units;
  std::vector<std::string> names, values, limits;
  std::vector<Cell> marks;
  const auto add = [&](const std::string& name, const std::string& value, const std::string& limit, bool met) {
    names.push_back(name);
    values.push_back(value);
    limits.push_back(limit);
    marks.push_back(met ? Cell{"met", Tone::good} : Cell{"missed", Tone::bad});
  };
  add("travel of " + problem.scene.name_of(problem.guided), in_length(facts.travel, units),
      "= " + in_length(problem.travel, units), true);
  add("drift across its line", in_length(facts.drift, units), "<= " + in_length(problem.drift, units),
      facts.drift <= problem.drift);
  add("inclination of " + problem.scene.bodies[problem.level].name, in_degrees(facts.inclination),
      "<= " + in_degrees(problem.inclination), facts.inclination <= problem.inclination);
  const DesignModel model(problem);
  for (std::size_t i = 0; i < facts.transmission.size(); ++i) {
    add("transmission at " + model.chain().dyads()[i].joint, in_degrees(facts.transmission[i]),
        ">= " + in_degrees(problem.transmission), facts.transmission[i] >= problem.transmission);
  }
  for (std::size_t i = 0; i < facts.strokes.size(); ++i) {
    const DesignFacts::Stroke& stroke = facts.strokes[i];
    const Actuator& jack = problem.actuators[i];
    add(jack.name, in_length(stroke.shortest, units) + " to " + in_length(stroke.longest, units),
        "ratio <= " + significant(jack.ratio, digits), stroke.longest <= jack.ratio * stroke.shortest);
    add("its least lever arm", in_length(stroke.least_lever, units), ">= " + in_length(jack.lever, units),
        stroke.least_lever >= jack.lever);
  }
  add("shortest link", in_length(facts.shortest, units), ">= " + in_length(problem.shortest, units),
      facts.shortest >= problem.shortest);
  add("longest span of a body", in_length(facts.longest, units), "<= " + in_length(problem.longest, units),
      facts.longest <= problem.longest);
  Table table;
  table.add_text_column("goal", names);
  table.add_number_column("reached", values);
  table.add_text_column("asked for", limits);
  table.add_text_column("", marks);
  return section("Goals", table.print(palette), palette);
}

std::string dimension_section(const Scene& scene, const Palette& palette) {
  std::vector<std::string> names;
  std::vector<double> x, y;
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& p : body.points) {
      names.push_back(body.name + "." + p.name);
      x.push_back(in_unit(p.at.x, Quantity::length, scene.units));
      y.push_back(in_unit(p.at.y, Quantity::length, scene.units));
    }
  }
  Table table;
  table.add_text_column("point", names);
  table.add_number_column("x", aligned(x, digits));
  table.add_number_column("y", aligned(y, digits));
  return section(with_unit("Points in their bodies' frames", Quantity::length, scene.units), table.print(palette),
                 palette);
}

}  // namespace

std::string design_report(const DesignProblem& problem, const DesignResult& result, const DesignCheck& check,
                          double microseconds, const Palette& palette) {
  std::string out = heading(problem.title.empty() ? problem.file : problem.title, problem.source, palette) +
                    verdict(result, check, microseconds, palette);
  if (result.values.empty()) return out;
  // Of dimensions that the general kinematics could not follow only the search's own view is left.
  const bool followed = check.closeness > 0.0;
  out += fact("driven",
              fmt::format("{} from {} to {}", problem.scene.bodies[problem.driver].name, in_degrees(result.from),
                          in_degrees(result.to)),
              palette);
  if (followed) {
    out += fact("closeness", significant(check.closeness, 3) + " to a singular pose at worst", palette);
  }
  return out + goal_section(problem, followed ? check.facts : result.facts, palette) +
         dimension_section(result.scene, palette);
}

std::string design_json(const DesignProblem& problem, const DesignResult& result, const DesignCheck& check,
                        std::uint64_t seed) {
  const Units& units = problem.scene.units;
  const auto shown = [&](double si) { return json_number(in_unit(si, Quantity::length, units)); };
  const DesignModel model(problem);
  Json out = {{"poise", POISE_VERSION},
              {"design", {{"file", problem.file}, {"title", problem.title}, {"source", problem.source}}},
              {"units", json_units(units)},
              {"met", result.met && check.met},
              {"why", check.why},
              {"starts", result.starts},
              {"evaluations", result.evaluations},
              {"seed", seed}};
  out["goals"] = {{"travel", shown(problem.travel)},     {"drift", shown(problem.drift)},
                  {"inclination", problem.inclination},  {"transmission", problem.transmission},
                  {"shortest", shown(problem.shortest)}, {"longest", shown(problem.longest)}};
  if (result.values.empty()) return json_text(out, problem.scene);
  const DesignFacts& facts = check.closeness > 0.0 ? check.facts : result.facts;
  Json& reached = out["facts"];
  reached = {{"travel", shown(facts.travel)},
             {"drift", shown(facts.drift)},
             {"inclination", json_number(facts.inclination)},
             {"transmission", Json::object()},
             {"actuators", Json::array()},
             {"shortest", shown(facts.shortest)},
             {"longest", shown(facts.longest)},
             {"closeness_to_singular", json_number(check.closeness)}};
  for (std::size_t i = 0; i < facts.transmission.size(); ++i) {
    reached["transmission"][model.chain().dyads()[i].joint] = json_number(facts.transmission[i]);
  }
  for (std::size_t i = 0; i < facts.strokes.size(); ++i) {
    const DesignFacts::Stroke& stroke = facts.strokes[i];
    reached["actuators"].push_back({{"name", problem.actuators[i].name},
                                    {"shortest", shown(stroke.shortest)},
                                    {"longest", shown(stroke.longest)},
                                    {"least_lever", shown(stroke.least_lever)}});
  }
  out["drive"] = {{"body", problem.scene.bodies[problem.driver].name}, {"from", result.from}, {"to", result.to}};
  for (const Body& body : result.scene.bodies) {
    for (const NamedPoint& p : body.points) out["points"][body.name + "." + p.name] = {shown(p.at.x), shown(p.at.y)};
  }
  return json_text(out, problem.scene);
}

}  // namespace poise::app
