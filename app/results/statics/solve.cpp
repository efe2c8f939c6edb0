#include "app/results/statics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

Line verdict(const Equilibrium& equilibrium) {
  const Check& check = equilibrium.check;
  switch (equilibrium.status) {
    case Status::confirmed:
      return {.text = check.stability == Stability::unknown
                          ? "In equilibrium, confirmed; whether it is stable is unknown."
                          : fmt::format("In equilibrium, confirmed: {}.", to_string(check.stability)),
              .tone = tone_of(check.stability)};
    case Status::not_confirmed:
      return bad("Not confirmed: the method claims an equilibrium, the independent check does not confirm it.");
    case Status::not_applicable:
      return bad("Not applicable: this method cannot solve this scene.");
    case Status::interrupted:
      return bad("Interrupted.");
    case Status::not_found:
    case Status::not_solved:
      break;
  }
  return bad("No equilibrium found.");
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
        doubtful("The mechanism would leave this equilibrium; --seek stable searches for one in which it stays."));
  }
  if (equilibrium.check.neutral_directions == 0 && answer.reference && !answer.reference->refined) {
    result.warnings.push_back(bad("Not verified in 50 digits: " + answer.reference->why + "."));
  }
}

void warn_of_dead_centre(Result& result, const StaticModel& model, const Answer& answer) {
  const std::optional<HeavyReaction> heavy = heavy_reaction(model, answer);
  if (!heavy) return;
  result.warnings.push_back(doubtful(fmt::format(
      "Near a dead centre: {} \"{}\" carries {}, for loads of {} in all; a small change of a dimension changes this "
      "force greatly.",
      heavy->kind, heavy->name, with_unit(model, heavy->force, Quantity::force, 4),
      with_unit(model, heavy->load, Quantity::force, 4))));
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

/// An element, with the name of its table in front where an earlier one of the list has the same name.
struct NamedElement {
  std::size_t place;
  std::string name;
};

/// The elements that store energy, on angles or on lengths.
std::vector<NamedElement> springs_of(const Scene& scene, bool on_angles) {
  std::set<std::string> taken;
  std::vector<NamedElement> out;
  for (std::size_t i = 0; i < scene.elements.size(); ++i) {
    const Element& element = scene.elements[i];
    if (!stores_energy(element.law) || element.on.is_angle() != on_angles) continue;
    const bool is_new = taken.insert(element.name).second;
    out.push_back({i, is_new ? element.name : element.table + "." + element.name});
  }
  return out;
}

void add_springs(Group& group, const StaticModel& model, const Readings& readings) {
  const std::vector<NamedElement> springs = springs_of(model.scene(), false);
  const auto read = [&](const NamedElement& spring) -> const ElementReading& {
    return readings.elements[spring.place];
  };
  const double nothing =
      unit_value(Quantity::force, model.scene().units) * format_of(model, Quantity::force, force_digits).zero_below;
  Table& table = group.table("springs", "Springs, tension positive", Rows::by_name);
  table.words("name", "name", each(springs, &NamedElement::name));
  add_column(table, model, "length", "length", Quantity::length,
             each(springs, [&](const NamedElement& s) { return read(s).value; }), force_digits);
  add_column(table, model, "force", "force", Quantity::force,
             each(springs, [&](const NamedElement& s) { return read(s).force; }), force_digits);
  table.flags("slack", each(springs, [&](const NamedElement& s) { return read(s).slack; }));
  table.remarks(each(springs,
                     [&](const NamedElement& s) {
                       return read(s).slack              ? "slack"
                              : read(s).force > nothing  ? "in tension"
                              : read(s).force < -nothing ? "in compression"
                                                         : "unloaded";
                     }),
                Tone::faint);
}

void add_torsion_springs(Group& group, const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  const std::vector<NamedElement> springs = springs_of(scene, true);
  const auto body = [&](const NamedElement& spring) { return second_body(scene, scene.elements[spring.place].on); };
  Table& table = group.table("torsion_springs", "Torsion springs, moment on the named body", Rows::by_name);
  table.words("name", "name", each(springs, &NamedElement::name));
  table.words("on", "on", each(springs, body));
  add_column(table, model, "moment", "moment", Quantity::moment,
             each(springs, [&](const NamedElement& s) { return -readings.elements[s.place].force; }), force_digits);
}

/// Stops in angles and in lengths: their values have different units, written behind each.
void add_stops(Group& group, const StaticModel& model, const Readings& readings, const Check& check) {
  const std::vector<Stop>& stops = model.scene().stops;
  const std::vector<std::size_t> rows = places(stops.size());
  const auto limit = [&](std::size_t i) -> std::string {
    const bool in_contact = std::any_of(check.reactions.begin(), check.reactions.end(),
                                        [&](const Reaction& r) { return r.kind == "stop" && r.name == stops[i].name; });
    return in_contact ? pressed_limit(stops[i], readings.stops[i]).name : "";
  };
  Table& table = group.table("stops", "Stops", Rows::by_name);
  table.words("name", "stop", each(stops, &Stop::name));
  const auto add = [&](const std::string& key, auto&& si) {
    table
        .numbers(
            key, key, "",
            each(rows, [&](std::size_t i) { return in_unit(si(i), quantity_of(stops[i].on), model.scene().units); }))
        .texts = each(rows, [&](std::size_t i) {
      return std::isfinite(si(i)) ? with_unit(model, si(i), quantity_of(stops[i].on)) : "-";
    });
  };
  add("value", [&](std::size_t i) { return readings.stops[i]; });
  add("min", [&](std::size_t i) { return stops[i].min; });
  add("max", [&](std::size_t i) { return stops[i].max; });
  Column& contact = table.words("active", "", each(rows, limit));
  contact.kind = Column::Kind::word_or_null;
  contact.texts =
      each(contact.words, [](const std::string& at) { return at.empty() ? "free" : "active at its " + at; });
  contact.tones = each(contact.words, [](const std::string& at) { return at.empty() ? Tone::faint : Tone::plain; });
}

void add_pose_data(Group& group, const StaticModel& model, const Readings& readings) {
  const Scene& scene = model.scene();
  const auto length = [&](double si) { return in_unit(si, Quantity::length, scene.units); };
  const auto values = [&](const std::string& key) -> Table& {
    return group.table(key, "", Rows::values, Verbosity::data);
  };
  const auto add_places = [](Table& table, std::vector<std::string> names, const std::vector<Vec2>& at, auto&& shown) {
    table.words("name", "", std::move(names));
    table.data("[]", each(at, [&](const Vec2& p) { return shown(p.x); }));
    table.data("[]", each(at, [&](const Vec2& p) { return shown(p.y); }));
  };
  std::vector<std::string> points;
  std::vector<Vec2> at;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (const NamedPoint& p : scene.bodies[i].points) {
      points.push_back(scene.bodies[i].name + "." + p.name);
      at.push_back(readings.poses[i].world(p.at));
    }
  }
  add_places(values("points"), std::move(points), at, length);
  const auto body = [&](std::size_t i) { return scene.bodies[i].name; };
  std::vector<std::size_t> moving = places(scene.bodies.size());
  moving.erase(moving.begin());
  Table& angles = values("angles");
  angles.words("name", "", each(moving, body));
  angles.data("value", each(moving, [&](std::size_t i) {
                return in_unit(readings.poses[i].angle, Quantity::angle, scene.units);
              }));
  const auto sliding =
      chosen_of(places(scene.joints.size()), [&](std::size_t j) { return scene.joints[j].has_travel(); });
  Table& slides = values("slides");
  slides.words("name", "", each(sliding, [&](std::size_t j) { return scene.joints[j].name; }));
  slides.data("value", each(sliding, [&](std::size_t j) { return length(readings.travel[j]); }));
  const std::vector<std::size_t> free = free_bodies(model.layout());
  std::vector<Vec2> origins;
  for (const std::size_t i : free) origins.push_back(readings.poses[i].origin);
  add_places(values("positions"), each(free, body), origins, length);
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
  add_coordinate_names(reference.table("coordinates", "", Rows::list, Verbosity::data), model.layout(),
                       answer.reference->decimal.size())
      .words("value", "", each(answer.reference->decimal, [](const std::string& text) { return text; }));
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
