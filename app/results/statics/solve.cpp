#include "app/results/statics/solve.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/cams.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/hold.hpp"
#include "app/results/statics/quantities.hpp"
#include "app/results/statics/settling.hpp"
#include "model/controllers.hpp"
#include "model/curved_slots.hpp"
#include "statics/proof/enclosed_reactions.hpp"
#include "statics/proof/principal_directions.hpp"
#include "statics/quantities/quantities_at.hpp"

namespace poise::app {
namespace {

Line verdict(const Equilibrium& equilibrium) {
  switch (equilibrium.status) {
    case Status::confirmed:
      return {.text = fmt::format("In equilibrium, {}.", in_few_words(equilibrium)),
              .tone = tone_of(equilibrium.certificate.stability)};
    case Status::checked:
      return doubtful(
          fmt::format("In equilibrium, {}: free-body statics finds every body in balance.", in_few_words(equilibrium)));
    case Status::not_confirmed:
      return bad("Not confirmed: the method claims an equilibrium, and none is proved there.");
    case Status::elsewhere:
      return bad("Went elsewhere: the method left the equilibrium in which the mechanism settles.");
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

/// What stability means where it is not that of an energy; empty where it is.
std::string stability_note(const StaticModel& model, const Certificate& certificate) {
  if (!certificate.confirmed()) return "only an equilibrium can be stable";
  if (certificate.locked) return certificate.active_stops.empty() ? "nothing can move" : "held by its stops";
  if (!model.mechanism().has_follower_loads()) return "";
  switch (certificate.stability) {
    case Stability::unstable:
      return "a follower load has no potential: it diverges, the determinant of its stiffness being negative";
    case Stability::unknown:
      return "a follower load has no potential: it does not diverge, but it may flutter, which statics cannot decide";
    default:
      return "a follower load has no potential: checked for divergence only (the sign of the stiffness)";
  }
}

/// The directions along which an equilibrium is unstable or neutral, and how that is to be understood.
void add_directions(Group& group, const StaticModel& model, const Certificate& certificate) {
  const std::vector<CurvatureDirection> directions = principal_directions(model, certificate);
  for (std::size_t k = 0; k < directions.size(); ++k) {
    const int index = static_cast<int>(k);
    if (index >= certificate.unstable_directions + certificate.neutral_directions) break;
    group.fact("direction",
               (index < certificate.unstable_directions ? "unstable: " : "neutral: ") + moves_in_words(directions[k]));
  }
  const std::string note = stability_note(model, certificate);
  if (certificate.confirmed() && !note.empty()) group.fact("stability", note);
}

/// What a reader of an unstable equilibrium must know.
void warn_of_doubt(Result& result, const Answer& answer, const std::string& seeks_stable) {
  const Equilibrium& equilibrium = answer.equilibrium;
  if (equilibrium.certificate.stability == Stability::unstable && equilibrium.seek != Seek::stable) {
    result.warnings.push_back(doubtful(fmt::format("The mechanism would leave this equilibrium; {}.", seeks_stable)));
  }
  if (equilibrium.found() && !equilibrium.check.is_equilibrium()) {
    result.warnings.push_back(doubtful(
        "Free-body statics, in double precision, does not find it in balance: " + equilibrium.check.objection + "."));
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
  const char* sought = equilibrium.seek == Seek::settle ? "the equilibrium in which it settles"
                       : method_traits.needs_potential  ? "a minimum of the energy"
                       : method_traits.minimises || equilibrium.seek == Seek::stable ? "a stable equilibrium"
                                                                                     : "the nearest equilibrium";
  std::string method = fmt::format("{}, seeking {}", to_string(equilibrium.method), sought);
  if (equilibrium.status == Status::not_applicable) return method;
  return fmt::format("{}: {}, {}, {}", method, count(equilibrium.iterations, "iteration", "iterations"),
                     count(equilibrium.evaluations, "evaluation", "evaluations"), duration(equilibrium.microseconds));
}

/// What is proved, what the scene's own numbers leave open, and what the method itself reached.
void add_proof(Group& group, const Equilibrium& equilibrium) {
  const Certificate& certificate = equilibrium.certificate;
  group.fact("proof", certificate.statement);
  if (!certificate.confirmed()) return;
  if (!certificate.strict) group.fact("at a limit", "a stop or one-way spring is exactly at the limit of acting");
  group.fact("rounding",
             fmt::format("of the scene's numbers may move it by {}", small_number(certificate.rounding_effect)));
  group.fact("error", "of the method " + small_number(certificate.moved));
}

/// Radii around values, and those of reactions' forces, in the units of the scene.
std::vector<double> radii_in_unit(const std::vector<double>& radii, const std::vector<double>& values,
                                  Quantity quantity, const Units& units) {
  std::vector<double> out;
  for (std::size_t i = 0; i < radii.size(); ++i) {
    out.push_back(radius_in_unit(radii[i], values[i], unit_value(quantity, units)));
  }
  return out;
}

std::vector<double> force_radii_in_unit(const std::vector<Reaction>& reactions, const Units& units) {
  const double unit = unit_value(Quantity::force, units);
  return each(reactions, [&](const Reaction& r) { return force_radius_in_unit(r, unit); });
}

std::vector<double> moment_radii_in_unit(const std::vector<Reaction>& reactions, const Units& units) {
  return radii_in_unit(each(reactions, &Reaction::moment_radius), each(reactions, &Reaction::moment), Quantity::moment,
                       units);
}

/// How close to the exact ones the forces shown are proved to be.
std::string proof_of_forces(const StaticModel& model, const Check& check) {
  const Units& units = model.scene().units;
  std::vector<double> forces = force_radii_in_unit(check.reactions, units);
  std::vector<double> moments = moment_radii_in_unit(check.reactions, units);
  for (std::size_t e = 0; e < check.element_forces.size(); ++e) {
    const bool is_moment = model.scene().elements[e].on.is_angle();
    const ElementForce& force = check.element_forces[e];
    const double unit = unit_value(is_moment ? Quantity::moment : Quantity::force, units);
    (is_moment ? moments : forces).push_back(radius_in_unit(force.radius, force.value, unit));
  }
  const auto is_proved = [](double radius) { return std::isfinite(radius); };
  const bool any =
      std::any_of(forces.begin(), forces.end(), is_proved) || std::any_of(moments.begin(), moments.end(), is_proved);
  std::vector<std::string> parts;
  const auto add = [&](const std::string& what, double radius, Quantity quantity) {
    parts.push_back(fmt::format("{} proved to {} {}", what, small_number(radius), unit_name(quantity, units)));
  };
  if (any) add("forces", widest(forces), Quantity::force);
  if (widest(moments) > 0.0) add("moments", widest(moments), Quantity::moment);
  const auto add_count = [&](bool determined, const std::string& what) {
    const auto number = std::count_if(check.reactions.begin(), check.reactions.end(), [&](const Reaction& r) {
      return !std::isfinite(r.radius) && r.determined == determined;
    });
    if (number > 0)
      parts.push_back(fmt::format("those of {} {}", count(static_cast<int>(number), "joint", "joints"), what));
  };
  add_count(true, "in double precision");
  add_count(false, "not determined");
  return fmt::format("{}", fmt::join(parts, ", "));
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
  const std::vector<double> lengths = each(springs, [&](const NamedElement& s) { return read(s).value; });
  // What a force is known to tells what its spring's length is.
  const std::vector<double> length_radii = each(springs, [&](const NamedElement& s) {
    const double rate = force_at_rest(model.scene().elements[s.place].law, read(s).value).by_measure;
    return rate == 0.0 ? 0.0 : read(s).radius / std::abs(rate);
  });
  add_column(table, model, "length", "length", Quantity::length, lengths, force_digits, widest(length_radii));
  const std::vector<double> forces = each(springs, [&](const NamedElement& s) { return read(s).force; });
  const std::vector<double> radii = each(springs, [&](const NamedElement& s) { return read(s).radius; });
  add_column(table, model, "force", "force", Quantity::force, forces, force_digits, widest(radii));
  table.data("radius", radii_in_unit(radii, forces, Quantity::force, model.scene().units));
  table.flags("slack", each(springs, [&](const NamedElement& s) { return read(s).slack; }));
  table.remarks(each(springs,
                     [&](const NamedElement& s) {
                       const double size = std::abs(read(s).force);
                       const double radius = std::isfinite(read(s).radius) ? read(s).radius : 0.0;
                       if (read(s).slack) return "slack";
                       if (std::max(size, radius) <= nothing) return "unloaded";
                       if (size <= radius) return "in tension or compression";
                       return read(s).force > 0.0 ? "in tension" : "in compression";
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
  const std::vector<double> moments =
      each(springs, [&](const NamedElement& s) { return -readings.elements[s.place].force; });
  const std::vector<double> radii =
      each(springs, [&](const NamedElement& s) { return readings.elements[s.place].radius; });
  add_column(table, model, "moment", "moment", Quantity::moment, moments, force_digits, widest(radii));
  table.data("radius", radii_in_unit(radii, moments, Quantity::moment, scene.units));
}

/// "holds with a coefficient of friction from 0.12 on": |T| / N of a wheel on its line, stops `contact` and `friction`.
std::string friction_needed(std::size_t contact, std::size_t friction, const Check& check) {
  const Resultant along = resultant_of_stops(check.reactions, friction, 1),
                  across = resultant_of_stops(check.reactions, contact, 1);
  constexpr double rounding = 1e-9;
  if (along.force <= rounding * check.largest_force) return "holds without friction";
  if (across.force <= rounding * check.largest_force) return "holds with no coefficient of friction";
  const double ratio = along.force / across.force;
  const double radius = (along.radius + ratio * across.radius) / std::max(across.force - across.radius, 0.0);
  return "holds with a coefficient of friction from " + significant(ratio, 4, radius) + " on";
}

/// Stops in angles and in lengths: their values have different units, written behind each.
void add_stops(Group& group, const StaticModel& model, const Readings& readings, const ValueRadii& radii,
               const Check& check) {
  const std::vector<Stop>& stops = model.scene().stops;
  const std::vector<std::size_t> rows = places(stops.size());
  const auto limit = [&](std::size_t i) -> std::string {
    return reaction_of_stop(check.reactions, i) != nullptr ? pressed_limit(stops[i], readings.stops[i]).name : "";
  };
  const bool any_coupling =
      std::any_of(stops.begin(), stops.end(), [](const Stop& stop) { return stop.table != "stop"; });
  Table& table = group.table("stops", any_coupling ? "Stops, couplings and ropes" : "Stops", Rows::by_name);
  table.words("name", "stop", each(stops, &Stop::name));
  table.words("kind", "kind", each(stops, &Stop::family)).shown = any_coupling;
  const auto add = [&](const std::string& key, auto&& si, auto&& radius) {
    table
        .numbers(
            key, key, "",
            each(rows, [&](std::size_t i) { return in_unit(si(i), quantity_of(stops[i].on), model.scene().units); }))
        .texts = each(rows, [&](std::size_t i) {
      return std::isfinite(si(i)) ? with_unit(model, si(i), quantity_of(stops[i].on), force_digits, radius(i)) : "-";
    });
  };
  const auto exact = [](std::size_t) { return 0.0; };
  add(
      "value", [&](std::size_t i) { return readings.stops[i]; },
      [&](std::size_t i) { return radii.stops.empty() ? 0.0 : radii.stops[i]; });
  add(
      "min", [&](std::size_t i) { return stops[i].min; }, exact);
  add(
      "max", [&](std::size_t i) { return stops[i].max; }, exact);
  Column& contact = table.words("active", "", each(rows, limit));
  contact.kind = Column::Kind::word_or_null;
  contact.texts = each(rows, [&](std::size_t i) -> std::string {
    if (stops[i].table == "curved_slot" && contact.words[i].empty()) {
      const Resultant track = resultant_of_stops(check.reactions, i + 1, 2);
      return "free, the track presses with " +
             with_unit(model, track.force, Quantity::force, force_digits, track.radius);
    }
    if (stops[i].table.starts_with("rolling") && stops[i].table.ends_with("_friction"))
      return friction_needed(i - 1, i, check);
    if (stops[i].couples()) return "holds";
    if (stops[i].table == "rope") return contact.words[i].empty() ? "slack" : "taut";
    if (stops[i].table == "cam") return contact.words[i].empty() ? "lifted off" : "in contact";
    return contact.words[i].empty() ? "free" : "active at its " + contact.words[i];
  });
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
  const std::set<int> states = bodies_of_states(scene);
  const auto is_state = [&](std::size_t i) { return states.contains(static_cast<int>(i)); };
  moving.erase(moving.begin());
  std::erase_if(moving, is_state);
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
  std::vector<std::size_t> free = free_bodies(model.layout());
  std::erase_if(free, is_state);
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
  const Certificate& certificate = equilibrium.certificate;
  const Units& units = model.scene().units;
  group.data("stability", to_string(certificate.stability));
  group.data("stability_note", stability_note(model, certificate));
  group.data("unstable_directions", certificate.unstable_directions);
  group.data("neutral_directions", certificate.neutral_directions);
  Group& proved = group.group("certificate", "", Verbosity::data);
  proved.data("outcome", to_string(certificate.outcome));
  proved.data("statement", certificate.statement);
  proved.data("radius", certificate.confirmed() ? std::optional(certificate.radius) : std::nullopt);
  proved.data("rounding_effect", certificate.confirmed() ? std::optional(certificate.rounding_effect) : std::nullopt);
  proved.data("strictly_complementary", certificate.strict);
  proved.data("locked", certificate.locked);
  proved.data("redundant_rows", certificate.redundant);
  proved.data("least_joint_force", certificate.singular
                                       ? std::optional(in_unit(certificate.least_joint_force, Quantity::force, units))
                                       : std::nullopt);
  proved.list("neutral_coordinates", "", certificate.neutral_coordinates, Verbosity::data);
  Branch& directions = group.array("directions");
  for (const CurvatureDirection& direction : principal_directions(model, certificate)) {
    Group& one = directions.parts.emplace_back();
    one.data("curvature", in_unit(direction.curvature, Quantity::energy, units));
    Group& moves = one.group("parts", "", Verbosity::data);
    for (const auto& [name, part] : direction.moves) moves.data(name, part);
  }
  group.data("redundancy", check.redundancy);
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
  group.data("seek", to_string(equilibrium.seek));
  add_settling_data(group, model, equilibrium);
  group.data("status", to_string(equilibrium.status));
  group.data("why", equilibrium.why);
  group.data("iterations", equilibrium.iterations);
  group.data("evaluations", equilibrium.evaluations);
  group.data("microseconds", equilibrium.microseconds);
  group.data("error", error_of(answer));
  add_reference(group, model, answer);
  add_mobility(group, answer.freedoms);
  // Of a method that does not apply there is no pose.
  if (answer.readings) return;
  for (const char* key :
       {"energy", "energy_note", "stability", "stability_note", "unstable_directions", "neutral_directions",
        "certificate", "directions", "points", "angles", "slides", "positions", "springs", "torsion_springs", "stops",
        "reactions", "redundancy", "forces_on_bodies", "residuals"}) {
    group.data(key, nullptr);
  }
}

void add_pose(Group& group, const StaticModel& model, const Answer& answer) {
  add_springs(group, model, *answer.readings);
  add_torsion_springs(group, model, *answer.readings);
  // The rider along a curved slot carries nothing, a line of centres what the contact does.
  const auto is_hidden = [&scene = model.scene()](const Reaction& r) {
    return r.joint >= 0 && is_of_track(scene, scene.joints[static_cast<std::size_t>(r.joint)]);
  };
  std::vector<Reaction> reactions;
  for (const Reaction& reaction : answer.equilibrium.check.reactions) {
    if (!is_hidden(reaction)) reactions.push_back(reaction);
  }
  reactions = reaction_rows(reactions);
  Table& table = add_reactions(group, model, reactions, answer.equilibrium.check.redundancy);
  const Units& units = model.scene().units;
  table.data("radius", force_radii_in_unit(reactions, units));
  table.data("moment_radius", moment_radii_in_unit(reactions, units));
  add_stops(group, model, *answer.readings, answer.radii, answer.equilibrium.check);
  add_cams(group, model, cam_readings(model.scene(), answer.readings->poses, answer.equilibrium.check.reactions),
           answer.radii.cams);
  add_pose_data(group, model, *answer.readings);
  add_forces_on_bodies(group, model, answer.readings->poses, answer.equilibrium.check);
  add_check_data(group, model, answer.equilibrium);
  group.data("energy_note", energy_note);
}

std::optional<double> energy_of(const StaticModel& model, const Equilibrium& equilibrium) {
  if (!equilibrium.energy || !std::isfinite(*equilibrium.energy)) return std::nullopt;
  return in_unit(*equilibrium.energy, Quantity::energy, model.scene().units);
}

}  // namespace

Tone tone_of(Status status) {
  return status == Status::confirmed ? Tone::good : status == Status::checked ? Tone::doubtful : Tone::bad;
}

std::string kind_of(const Answer& answer) {
  const Stability stability = answer.equilibrium.certificate.stability;
  return stability == Stability::unknown ? "of unknown stability" : to_string(stability);
}

void add_answer_data(Group& group, const StaticModel& model, const Answer& answer) {
  add_search_data(group, model, answer);
  if (!answer.readings) return;
  add_pose(group, model, answer);
  group.data("energy", energy_of(model, answer.equilibrium));
}

Result solve_result(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings,
                    const HeldPose* as_drawn, const std::vector<SoughtQuantity>& show,
                    const std::string& seeks_stable) {
  const Equilibrium& equilibrium = answer.equilibrium;
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(equilibrium);
  warn_of_friction(out, model.scene());
  warn_of_blades(out, model.scene());
  warn_of_unloaded_bearings(out, model.scene());
  Group& content = out.content;
  if (equilibrium.found() && answer.readings) {
    warn_of_doubt(out, answer, seeks_stable);
    warn_of_dead_centre(out, model, answer);
  } else {
    content.fact("why", equilibrium.why);
  }
  warn_of_shaky(out, "Here", {answer});
  show_settling(out, model, equilibrium);
  if (as_drawn != nullptr) {
    Group& friction = content.group("as_drawn", "", Verbosity::normal);
    add_held_data(friction, model, *as_drawn);
    friction.fact("as drawn", held_in_words(*as_drawn));
  }
  add_search_data(content, model, answer);
  if (answer.readings) {
    add_directions(content, model, equilibrium.certificate);
    add_coordinates(content, model, {&*answer.readings},
                    {equilibrium.found()                       ? "equilibrium"
                     : equilibrium.status == Status::checked   ? "reached, not proved"
                     : equilibrium.status == Status::elsewhere ? "another equilibrium"
                                                               : "reached, no equilibrium"},
                    radius_of(equilibrium));
    if (equilibrium.found() && !show.empty()) {
      const std::vector<int>& active = equilibrium.certificate.active_stops;
      const RestingPlace place = resting_place(model, equilibrium.x, active, -1, other_quantity);
      add_quantities(content, show, quantity_values(place, show), model.scene().units);
    }
    add_pose(content, model, answer);
  }
  content.list("left_out", "Left out of statics", model.layout().dropped);
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("method", effort(equilibrium));
  show_settling_effort(numerics, equilibrium);
  if (!answer.readings) return out;
  add_proof(numerics, equilibrium);
  if (equilibrium.found()) numerics.fact("reactions", proof_of_forces(model, equilibrium.check));
  numerics.fact("residuals", residuals(model, equilibrium.check));
  const std::optional<double> energy = energy_of(model, equilibrium);
  if (energy) {
    const Format format = format_of_energies(model, {&answer, 1}, Format::Style::significant);
    numerics.entry("energy", "energy", *energy, unit_name(Quantity::energy, model.scene().units), format,
                   fmt::format("({})", energy_note), Verbosity::verbose);
  } else {
    content.data("energy", nullptr);
  }
  if (equilibrium.found()) numerics.fact("ended", equilibrium.why, Tone::plain, Verbosity::verbose);
  return out;
}

}  // namespace poise::app
