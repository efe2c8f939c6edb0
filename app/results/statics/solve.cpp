#include "app/results/statics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

/// A joint force so many times the largest load is that of a mechanism close to a dead centre.
constexpr double near_dead_centre = 100.0;

Line verdict(const Equilibrium& equilibrium) {
  const Check& check = equilibrium.check;
  switch (equilibrium.status) {
    case Status::confirmed:
      return {.text = check.stability == Stability::unknown
                          ? "In equilibrium, confirmed; whether it is stable is unknown."
                          : fmt::format("In equilibrium, confirmed: {}.", to_string(check.stability)),
              .tone = tone_of(check.stability)};
    case Status::not_confirmed:
      return {.text = "Not confirmed: the method claims an equilibrium, the independent check does not confirm it.",
              .tone = Tone::bad};
    case Status::not_applicable:
      return {.text = "Not applicable: this method cannot solve this scene.", .tone = Tone::bad};
    case Status::interrupted:
      return {.text = "Interrupted.", .tone = Tone::bad};
    case Status::not_found:
    case Status::not_solved:
      break;
  }
  return {.text = "No equilibrium found.", .tone = Tone::bad};
}

/// "link4 +0.79, link6 -0.49".
std::string moves_in_words(const CurvatureDirection& direction) {
  std::string text;
  for (const auto& [name, part] : direction.moves) {
    text += fmt::format("{}{} {:+.2f}", text.empty() ? "" : ", ", name, part);
  }
  return text;
}

/// The directions along which an equilibrium is unstable or neutral, and what of a neutral one is known.
void add_directions(Group& group, const Check& check) {
  for (std::size_t k = 0; k < check.principal_directions.size(); ++k) {
    const int index = static_cast<int>(k);
    if (index >= check.unstable_directions + check.neutral_directions) break;
    group.fact("direction", (index < check.unstable_directions ? "unstable: " : "neutral: ") +
                                moves_in_words(check.principal_directions[k]));
  }
  if (!check.stability_note.empty()) group.fact("stability", check.stability_note);
}

/// What a reader of an unstable equilibrium, or of one without a reference, must know.
void warn_of_doubt(Result& result, const Answer& answer) {
  const Equilibrium& equilibrium = answer.equilibrium;
  if (equilibrium.check.stability == Stability::unstable && equilibrium.seek == Seek::nearest) {
    result.warnings.push_back(
        {.text = "The mechanism would leave this equilibrium; --seek stable searches for one in which it stays.",
         .tone = Tone::doubtful});
  }
  if (equilibrium.check.neutral_directions == 0 && answer.reference && !answer.reference->refined) {
    result.warnings.push_back({.text = "Not verified in 50 digits: " + answer.reference->why + ".", .tone = Tone::bad});
  }
}

/// The largest load on the mechanism, N: forces, weights, torques over the mechanism's size, and of a spring what it
/// carried at the start too: what it carries besides is a consequence of the other loads.
double largest_load(const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  const double size = model.scales().length;
  double largest = 0.0;
  for (const Force& force : scene.forces) largest = std::max(largest, norm(force.vector));
  for (const Torque& torque : scene.torques) largest = std::max(largest, std::abs(torque.value) / size);
  for (const Body& body : scene.bodies) largest = std::max(largest, body.mass * norm(scene.gravity));
  const Readings start = read_off(model, assemble(model));
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const double force = std::min(std::abs(start.elements[i].force), std::abs(readings.elements[i].force));
    largest = std::max(largest, scene.elements[i].on.is_angle() ? force / size : force);
  }
  return largest;
}

void warn_of_dead_centre(Result& result, const StaticModel& model, const Answer& answer) {
  const std::vector<Reaction>& reactions = answer.equilibrium.check.reactions;
  const auto heaviest = std::max_element(reactions.begin(), reactions.end(), [](const Reaction& a, const Reaction& b) {
    return norm(a.force) < norm(b.force);
  });
  if (heaviest == reactions.end()) return;
  const double load = largest_load(model, *answer.readings);
  if (load <= 0.0 || norm(heaviest->force) < near_dead_centre * load) return;
  result.warnings.push_back(
      {.text = fmt::format("Near a dead centre: {} \"{}\" carries {}, for loads of {} at most; a small change of a "
                           "dimension changes this force greatly.",
                           heaviest->kind, heaviest->name, with_unit(model, norm(heaviest->force), Quantity::force, 4),
                           with_unit(model, load, Quantity::force, 4)),
       .tone = Tone::doubtful});
}

std::string effort(const Equilibrium& equilibrium) {
  const MethodTraits& method_traits = traits(equilibrium.method);
  const char* sought = method_traits.needs_potential                                 ? "a minimum of the energy"
                       : method_traits.minimises || equilibrium.seek == Seek::stable ? "a stable equilibrium"
                                                                                     : "the nearest equilibrium";
  std::string method = fmt::format("{}, seeking {}", to_string(equilibrium.method), sought);
  if (equilibrium.status == Status::not_applicable) return method;
  return fmt::format("{}: {}, {}, {}", method, count(equilibrium.iterations, "iteration", "iterations"),
                     count(equilibrium.evaluations, "evaluation", "evaluations"), duration(equilibrium.microseconds));
}

int digits_of(double accuracy) { return std::max(0, static_cast<int>(std::floor(-std::log10(accuracy)))); }

/// "13 digits (rounding may move it by 2e-14 rad, or length over size); error 4e-16 from the 50-digit reference".
std::string accuracy(const Answer& answer) {
  const Check& check = answer.equilibrium.check;
  const bool neutral = check.neutral_directions > 0 && check.accuracy_across_neutral.has_value();
  const std::optional<double>& limit = neutral ? check.accuracy_across_neutral : check.accuracy;
  std::string text;
  if (limit && std::isfinite(*limit)) {
    text = fmt::format("{}{} (rounding may move it by {})",
                       neutral ? "arbitrary along the neutral direction, across it " : "",
                       count(digits_of(*limit), "digit", "digits"), small_number(*limit));
  }
  const auto add = [&](const std::string& words) { text += (text.empty() ? "" : "; ") + words; };
  if (answer.reference && answer.reference->refined) {
    add(fmt::format("error {} from the 50-digit reference", small_number(answer.reference->error)));
  } else if (answer.reference) {
    add("error not measured: " + answer.reference->why);
  }
  return text.empty() ? text : text + " [rad, or length over size]";
}

std::string residuals(const StaticModel& model, const Check& check) {
  const Units& units = model.scene().units;
  std::string text = fmt::format("closure {} {}, imbalance {} {} (largest force {})",
                                 small_number(in_unit(check.closure_error, Quantity::length, units)), units.length_name,
                                 small_number(in_unit(check.imbalance, Quantity::force, units)), units.force_name,
                                 with_unit(model, check.largest_force, Quantity::force, 4));
  if (!model.scene().stops.empty()) text += ", beyond stops by " + small_number(check.stop_violation);
  return text;
}

/// Names of the elements of one kind; with the table in front where one of another table has the same name.
class ElementNames {
 public:
  std::string of(const Element& element) {
    return taken_.emplace(element.name, 0).second ? element.name : element.table + "." + element.name;
  }

 private:
  std::map<std::string, int> taken_;
};

void add_springs(Group& group, const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, notes;
  std::vector<double> lengths, forces, slack;
  ElementNames keys;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) || element.on.is_angle()) continue;
    const ElementReading& reading = readings.elements[i];
    names.push_back(keys.of(element));
    lengths.push_back(reading.value);
    forces.push_back(reading.force);
    slack.push_back(reading.slack ? 1.0 : 0.0);
    const double nothing =
        unit_value(Quantity::force, scene.units) * format_of(model, Quantity::force, force_digits).zero_below;
    notes.emplace_back(reading.slack              ? "slack"
                       : reading.force > nothing  ? "in tension"
                       : reading.force < -nothing ? "in compression"
                                                  : "unloaded");
  }
  Table& table = group.table("springs", "Springs, tension positive", Rows::by_name);
  table.words("name", "name", std::move(names));
  add_column(table, model, "length", "length", Quantity::length, lengths, force_digits);
  add_column(table, model, "force", "force", Quantity::force, forces, force_digits);
  table.flags("slack", std::move(slack));
  table.remarks(std::move(notes), Tone::faint);
}

void add_torsion_springs(Group& group, const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, bodies;
  std::vector<double> moments;
  ElementNames keys;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) || !element.on.is_angle()) continue;
    names.push_back(keys.of(element));
    bodies.push_back(scene.bodies[element.on.kind == Measure::Kind::angle ? element.on.body_b : 0].name);
    moments.push_back(-readings.elements[i].force);
  }
  Table& table = group.table("torsion_springs", "Torsion springs, moment on the named body", Rows::by_name);
  table.words("name", "name", std::move(names));
  table.words("on", "on", std::move(bodies));
  add_column(table, model, "moment", "moment", Quantity::moment, moments, force_digits);
}

/// Stops in angles and in lengths: their values have different units, which stand behind them.
void add_stops(Group& group, const StaticModel& model, const Readings& readings, const Check& check) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, values, lows, highs, active;
  std::vector<double> value, low, high;
  std::vector<Tone> tones;
  for (std::size_t i = 0; i < scene.stops.size(); ++i) {
    const Stop& stop = scene.stops[i];
    const Quantity quantity = quantity_of(stop.on);
    const auto shown = [&](double si) { return std::isfinite(si) ? with_unit(model, si, quantity) : "-"; };
    names.push_back(stop.name);
    value.push_back(in_unit(readings.stops[i], quantity, scene.units));
    low.push_back(in_unit(stop.min, quantity, scene.units));
    high.push_back(in_unit(stop.max, quantity, scene.units));
    values.push_back(shown(readings.stops[i]));
    lows.push_back(shown(stop.min));
    highs.push_back(shown(stop.max));
    const bool in_contact = std::any_of(check.reactions.begin(), check.reactions.end(),
                                        [&](const Reaction& r) { return r.kind == "stop" && r.name == stop.name; });
    active.emplace_back(in_contact ? pressed_limit(stop, readings.stops[i]).name : "");
    tones.push_back(in_contact ? Tone::plain : Tone::faint);
  }
  Table& table = group.table("stops", "Stops", Rows::by_name);
  table.words("name", "stop", std::move(names));
  table.numbers("value", "value", "", std::move(value)).texts = std::move(values);
  table.numbers("min", "min", "", std::move(low)).texts = std::move(lows);
  table.numbers("max", "max", "", std::move(high)).texts = std::move(highs);
  Column& contact = table.words("active", "", std::move(active));
  contact.kind = Column::Kind::word_or_null;
  for (const std::string& limit : contact.words)
    contact.texts.push_back(limit.empty() ? "free" : "active at its " + limit);
  contact.tones = std::move(tones);
}

void add_pose_data(Group& group, const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  std::vector<std::string> points, bodies, joints, free;
  std::vector<double> x, y, angles, travels, free_x, free_y;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      const Vec2 at = readings.poses[i].world(p.at);
      points.push_back(scene.bodies[i].name + "." + p.name);
      x.push_back(in_unit(at.x, Quantity::length, scene.units));
      y.push_back(in_unit(at.y, Quantity::length, scene.units));
    }
    if (i == 0) continue;
    bodies.push_back(scene.bodies[i].name);
    angles.push_back(in_unit(readings.poses[i].angle, Quantity::angle, scene.units));
  }
  for (std::size_t j = 0; j < scene.joints.size(); ++j) {
    if (!scene.joints[j].has_travel()) continue;
    joints.push_back(scene.joints[j].name);
    travels.push_back(in_unit(readings.travel[j], Quantity::length, scene.units));
  }
  for (const std::size_t i : free_bodies(model.layout())) {
    free.push_back(scene.bodies[i].name);
    free_x.push_back(in_unit(readings.poses[i].origin.x, Quantity::length, scene.units));
    free_y.push_back(in_unit(readings.poses[i].origin.y, Quantity::length, scene.units));
  }
  const auto add = [&](const std::string& key, std::vector<std::string> names, std::vector<std::vector<double>> parts) {
    Table& table = group.table(key, "", Rows::values, Verbosity::data);
    table.words("name", "", std::move(names));
    for (std::vector<double>& part : parts) table.data(parts.size() > 1 ? "[]" : "value", std::move(part));
  };
  add("points", std::move(points), {std::move(x), std::move(y)});
  add("angles", std::move(bodies), {std::move(angles)});
  add("slides", std::move(joints), {std::move(travels)});
  add("positions", std::move(free), {std::move(free_x), std::move(free_y)});
}

void add_reference(Group& group, const StaticModel& model, const Answer& answer) {
  if (!answer.reference) {
    group.data("reference", nullptr);
    return;
  }
  Group& reference = group.group("reference", "", Verbosity::data);
  reference.data("refined", answer.reference->refined);
  reference.data("digits", answer.reference->digits);
  reference.data("why", answer.reference->why);
  std::vector<std::string> names, units, values;
  for (std::size_t i = 0; i < answer.reference->decimal.size(); ++i) {
    const Coordinate& c = model.layout().coordinates[i];
    names.push_back(c.name);
    units.emplace_back(c.kind == Coordinate::Kind::angle ? "rad" : "m");
    values.push_back(answer.reference->decimal[i]);
  }
  Table& coordinates = reference.table("coordinates", "", Rows::list, Verbosity::data);
  coordinates.words("name", "", std::move(names));
  coordinates.words("unit", "", std::move(units));
  coordinates.words("value", "", std::move(values));
}

void add_check_data(Group& group, const StaticModel& model, const Equilibrium& equilibrium) {
  const Check& check = equilibrium.check;
  const Units& units = model.scene().units;
  group.data("stability", to_string(check.stability));
  group.data("stability_note", check.stability_note);
  group.data("unstable_directions", check.unstable_directions);
  group.data("neutral_directions", check.neutral_directions);
  Branch& directions = group.array("directions");
  for (const CurvatureDirection& direction : check.principal_directions) {
    Group& one = directions.parts.emplace_back();
    one.data("curvature", in_unit(direction.curvature, Quantity::energy, units));
    Group& moves = one.group("parts", "", Verbosity::data);
    for (const auto& [name, part] : direction.moves) moves.data(name, part);
  }
  group.data("redundancy", check.redundancy);
  group.data("accuracy", check.accuracy);
  group.data("accuracy_across_neutral", check.accuracy_across_neutral);
  Group& residual = group.group("residuals", "", Verbosity::data);
  residual.data("closure_error", in_unit(check.closure_error, Quantity::length, units));
  residual.data("worst_joint", check.worst_joint);
  residual.data("imbalance", in_unit(check.imbalance, Quantity::force, units));
  residual.data("worst_body", check.worst_body);
  residual.data("largest_force", in_unit(check.largest_force, Quantity::force, units));
  residual.data("stop_violation", check.stop_violation);
  residual.data("worst_stop", check.worst_stop);
  residual.data("objection", check.objection);
}

/// How it was searched for, and how that ended.
void add_search_data(Group& group, const StaticModel& model, const Answer& answer) {
  const Equilibrium& equilibrium = answer.equilibrium;
  group.data("method", to_string(equilibrium.method));
  group.data("seek", equilibrium.seek == Seek::stable ? "stable" : "nearest");
  group.data("status", to_string(equilibrium.status));
  group.data("why", equilibrium.why);
  group.data("iterations", equilibrium.iterations);
  group.data("evaluations", equilibrium.evaluations);
  group.data("microseconds", equilibrium.microseconds);
  group.data("error", error_of(answer));
  add_reference(group, model, answer);
  // Of a method that does not apply there is no pose.
  if (answer.readings) return;
  for (const char* key :
       {"energy", "energy_note", "stability", "stability_note", "unstable_directions", "neutral_directions",
        "directions", "points", "angles", "slides", "positions", "springs", "torsion_springs", "stops", "reactions",
        "redundancy", "accuracy", "accuracy_across_neutral", "residuals"}) {
    group.data(key, nullptr);
  }
}

void add_pose(Group& group, const StaticModel& model, const Answer& answer) {
  add_springs(group, model, *answer.readings);
  add_torsion_springs(group, model, *answer.readings);
  add_reactions(group, model, answer.equilibrium.check.reactions, answer.equilibrium.check.redundancy);
  add_stops(group, model, *answer.readings, answer.equilibrium.check);
  add_pose_data(group, model, *answer.readings);
  add_check_data(group, model, answer.equilibrium);
  group.data("energy_note", energy_note);
}

std::optional<double> energy_of(const StaticModel& model, const Equilibrium& equilibrium) {
  if (!equilibrium.energy || !std::isfinite(*equilibrium.energy)) return std::nullopt;
  return in_unit(*equilibrium.energy, Quantity::energy, model.scene().units);
}

}  // namespace

Tone tone_of(Status status) { return status == Status::confirmed ? Tone::good : Tone::bad; }

std::string kind_of(const Answer& answer) {
  const Stability stability = answer.equilibrium.check.stability;
  return stability == Stability::unknown ? "of unknown stability" : to_string(stability);
}

void add_answer_data(Group& group, const StaticModel& model, const Answer& answer) {
  add_search_data(group, model, answer);
  if (!answer.readings) return;
  add_pose(group, model, answer);
  group.data("energy", energy_of(model, answer.equilibrium));
}

Result solve_result(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings) {
  const Equilibrium& equilibrium = answer.equilibrium;
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(equilibrium);
  warn_of_friction(out, model.scene());
  Group& content = out.content;
  if (equilibrium.found() && answer.readings) {
    warn_of_doubt(out, answer);
    warn_of_dead_centre(out, model, answer);
  } else {
    content.fact("why", equilibrium.why);
  }
  add_search_data(content, model, answer);
  if (answer.readings) {
    add_directions(content, equilibrium.check);
    add_coordinates(content, model, {&*answer.readings},
                    {equilibrium.found() ? "equilibrium" : "reached, no equilibrium"});
    add_pose(content, model, answer);
  }
  content.list("left_out", "Left out of statics", model.layout().dropped);
  Group& numerics = content.group("", "Numerics");
  numerics.fact("method", effort(equilibrium));
  if (!answer.readings) return out;
  const std::string digits = accuracy(answer);
  if (!digits.empty()) numerics.fact("accuracy", digits);
  numerics.fact("residuals", residuals(model, equilibrium.check));
  const std::optional<double> energy = energy_of(model, equilibrium);
  if (energy) {
    const Format format = format_of(model, Quantity::energy, coordinate_digits, Format::Style::significant);
    numerics.entry("energy", "energy", *energy, unit_name(Quantity::energy, model.scene().units), format,
                   fmt::format("({})", energy_note), Verbosity::verbose);
  } else {
    content.data("energy", nullptr);
  }
  if (equilibrium.found()) numerics.fact("ended", equilibrium.why, Tone::plain, Verbosity::verbose);
  return out;
}

}  // namespace poise::app
