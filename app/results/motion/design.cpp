#include "app/results/motion/design.hpp"

#include <numbers>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_dimensions = 6;
constexpr double degree = std::numbers::pi / 180;

std::string in_length(double si, const Units& units) {
  return significant(in_unit(si, Quantity::length, units), digits_of_dimensions) + " " + units.length_name;
}

std::string in_degrees(double si) { return significant(si / degree, digits_of_dimensions) + " deg"; }

Line verdict(const DesignResult& found, const DesignCheck& check) {
  if (found.values.empty()) return bad("Nothing was tried.");
  if (!found.met) return bad("No dimensions meet all goals yet; these come nearest.");
  if (!check.met) return bad("Not confirmed: " + check.why + ".");
  return good("Dimensions that meet all goals, confirmed by the general kinematics.");
}

void add_goals(Group& group, const DesignProblem& problem, const DesignFacts& facts) {
  const Units& units = problem.scene.units;
  struct Goal {
    std::string name, reached, required;
    bool met;
  };
  std::vector<Goal> goals;
  const auto add = [&](const std::string& name, const std::string& reached, const std::string& required, bool met) {
    goals.push_back({name, reached, required, met});
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
        "ratio <= " + significant(jack.ratio, digits_of_dimensions), stroke.longest <= jack.ratio * stroke.shortest);
    add("its least lever arm", in_length(stroke.least_lever, units), ">= " + in_length(jack.lever, units),
        stroke.least_lever >= jack.lever);
  }
  add("shortest link", in_length(facts.shortest, units), ">= " + in_length(problem.shortest, units),
      facts.shortest >= problem.shortest);
  add("longest span of a body", in_length(facts.longest, units), "<= " + in_length(problem.longest, units),
      facts.longest <= problem.longest);
  Table& table = group.table("", "Goals", Rows::list);
  table.words("", "goal", each(goals, &Goal::name));
  table.words("", "reached", each(goals, &Goal::reached));
  table.words("", "required", each(goals, &Goal::required));
  table.words("", "", each(goals, [](const Goal& goal) { return goal.met ? "met" : "missed"; })).tones =
      each(goals, [](const Goal& goal) { return goal.met ? Tone::good : Tone::bad; });
}

void add_dimensions(Group& group, const Scene& scene) {
  std::vector<std::string> names;
  std::vector<double> x, y;
  for (const Body& body : scene.bodies) {
    for (const NamedPoint& p : body.points) {
      names.push_back(body.name + "." + p.name);
      x.push_back(in_unit(p.at.x, Quantity::length, scene.units));
      y.push_back(in_unit(p.at.y, Quantity::length, scene.units));
    }
  }
  Table& table =
      group.table("points", fmt::format("Points in their bodies' frames ({})", scene.units.length_name), Rows::values);
  table.words("name", "point", std::move(names));
  table.numbers("[]", "x", "", std::move(x), {.digits = digits_of_dimensions});
  table.numbers("[]", "y", "", std::move(y), {.digits = digits_of_dimensions});
}

void add_goal_data(Group& group, const DesignProblem& problem) {
  const auto shown = [&](double si) { return in_unit(si, Quantity::length, problem.scene.units); };
  Group& goals = group.group("goals", "", Verbosity::data);
  goals.data("travel", shown(problem.travel));
  goals.data("drift", shown(problem.drift));
  goals.data("inclination", problem.inclination);
  goals.data("transmission", problem.transmission);
  goals.data("shortest", shown(problem.shortest));
  goals.data("longest", shown(problem.longest));
}

void add_reached_data(Group& group, const DesignProblem& problem, const DesignFacts& facts, double closeness) {
  const auto shown = [&](double si) { return in_unit(si, Quantity::length, problem.scene.units); };
  const DesignModel model(problem);
  Group& reached = group.group("facts", "", Verbosity::data);
  reached.data("travel", shown(facts.travel));
  reached.data("drift", shown(facts.drift));
  reached.data("inclination", facts.inclination);
  Group& transmission = reached.group("transmission", "", Verbosity::data);
  for (std::size_t i = 0; i < facts.transmission.size(); ++i) {
    transmission.data(model.chain().dyads()[i].joint, facts.transmission[i]);
  }
  Branch& actuators = reached.array("actuators");
  for (std::size_t i = 0; i < facts.strokes.size(); ++i) {
    const DesignFacts::Stroke& stroke = facts.strokes[i];
    Group& one = actuators.parts.emplace_back();
    one.data("name", problem.actuators[i].name);
    one.data("shortest", shown(stroke.shortest));
    one.data("longest", shown(stroke.longest));
    one.data("least_lever", shown(stroke.least_lever));
  }
  reached.data("shortest", shown(facts.shortest));
  reached.data("longest", shown(facts.longest));
  reached.data("closeness_to_singular", closeness);
}

}  // namespace

Result design_result(const DesignProblem& problem, const DesignResult& found, const DesignCheck& check,
                     std::uint64_t seed, double microseconds) {
  Result out = scene_result(problem.scene, {});
  out.title = problem.title.empty() ? problem.file : problem.title;
  out.source = problem.source;
  out.verdict = verdict(found, check);
  Group& content = out.content;
  Group& design = content.group("design", "", Verbosity::data);
  design.data("file", problem.file);
  design.data("title", problem.title);
  design.data("source", problem.source);
  content.data("met", found.met && check.met);
  content.data("why", check.why);
  content.data("starts", found.starts);
  content.data("evaluations", found.evaluations);
  content.data("seed", seed);
  add_goal_data(content, problem);
  // Of dimensions that the general kinematics could not follow, only what the search computed is known.
  const bool followed = check.closeness > 0.0;
  if (!found.values.empty()) {
    const std::string& driver = problem.scene.bodies[problem.driver].name;
    const DesignFacts& facts = followed ? check.facts : found.facts;
    content.fact("driven", fmt::format("{} from {} to {}", driver, in_degrees(found.from), in_degrees(found.to)));
    Group& drive = content.group("drive", "", Verbosity::data);
    drive.data("body", driver);
    drive.data("from", found.from);
    drive.data("to", found.to);
    add_reached_data(content, problem, facts, check.closeness);
    add_goals(content, problem, facts);
    add_dimensions(content, found.scene);
  }
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("search", fmt::format("{}, {}, {}", count(found.starts, "random start", "random starts"),
                                      count(static_cast<int>(found.evaluations), "candidate", "candidates"),
                                      duration(microseconds)));
  if (followed) numerics.fact("closeness", significant(check.closeness, 3) + " at worst to a singular position");
  return out;
}

}  // namespace poise::app
