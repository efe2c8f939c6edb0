#include "app/results/motion/motion.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/motion/contact_events.hpp"
#include "app/results/motion/forces_in_time.hpp"
#include "app/results/parts.hpp"
#include "model/controllers.hpp"
#include "model/meshing.hpp"

namespace poise::app {
namespace {

constexpr int rate_digits = 6;
// Errors up to so many times the accuracy asked for need no remark.
constexpr double remarkable_error = 100.0;

double reached(const Motion& motion) { return motion.trajectory.t.empty() ? 0.0 : motion.trajectory.t.back(); }

Line verdict(const MotionModel& model, const MotionAnswer& answer) {
  const Motion& motion = answer.found.motion;
  const std::optional<double>& error = answer.found.error;
  if (!motion.completed()) {
    return bad(fmt::format("Simulated {} s of {} s only: {}.", significant(reached(motion), 6),
                           significant(answer.duration, 6), motion.why));
  }
  const std::string moved = fmt::format("Simulated {} s", significant(answer.duration, 6));
  if (!error) return bad(moved + "; its error is not known: " + answer.found.why_unknown + ".");
  if (motion.energy_error >= ConfirmedMotion::useful) {
    return bad(moved + ", not confirmed: the energy balance does not close.");
  }
  if (!answer.found.confirmed()) {
    return bad(moved + ", not confirmed: small errors grow to the size of the motion.");
  }
  if (answer.forces) {
    const std::string objection = objection_to_forces(model, *answer.forces);
    if (!objection.empty()) return bad(moved + objection + ".");
  }
  if (*error > remarkable_error * answer.accuracy || motion.energy_error > remarkable_error * answer.accuracy) {
    return doubtful(moved + "; small errors grow along this motion.");
  }
  return good(moved + "; the energy balance closes.");
}

std::string effort(const Motion& motion) {
  std::string text = fmt::format("Runge-Kutta-Fehlberg of order 8: {}", count(motion.steps, "step", "steps"));
  if (motion.rejected > 0) text += fmt::format(", {} rejected", motion.rejected);
  return text +
         fmt::format(", {}, {}", count(motion.evaluations, "evaluation", "evaluations"), duration(motion.microseconds));
}

std::string error_in_words(const MotionAnswer& answer) {
  if (!answer.found.error) return "not estimated: the motion did not end";
  return fmt::format("{} of the range of each coordinate, estimated by a run ten times as accurate (asked for: {})",
                     small_number(*answer.found.error), answer.accuracy);
}

/// Singular poses that were passed, of which the first are named.
void add_singular(Group& group, const MotionModel& model, const Motion& motion) {
  constexpr std::size_t named = 6;
  const std::vector<SingularPlace> places = singular_places(model, motion, named);
  Branch& passages = group.array("passages");
  std::vector<std::string> lines;
  for (const SingularPlace& place : places) {
    Group& one = passages.parts.emplace_back();
    one.data("time", place.time);
    one.data("text", place.text);
    one.data("position", place.position);
    one.data("branch", place.branch);
    lines.push_back(fmt::format("passed at t = {} s: {}; it goes on with {}", significant(place.time, 6), place.text,
                                place.branch));
  }
  if (motion.singular.size() > named) lines.push_back(fmt::format("and {} more", motion.singular.size() - named));
  for (const std::string& line : lines) group.fact("singular", line);
}

/// The pose beyond which the drives cannot take the mechanism.
void add_dead_centre(Group& group, const Motion& motion) {
  if (!motion.dead_centre) {
    group.data("dead_centre", nullptr);
    return;
  }
  Group& place = group.group("dead_centre", "", Verbosity::data);
  place.data("time", motion.dead_centre->time);
  place.data("text", motion.dead_centre->text);
  place.data("position", motion.dead_centre->position);
}

enum class Moving { angle, travel, place };

Moving kind_of_channel(const MotionModel& model, const Channel& channel) {
  if (channel.quantity == Quantity::angle) return Moving::angle;
  const std::vector<int>& travel = model.layout().travel;
  return std::find(travel.begin(), travel.end(), channel.coordinate) != travel.end() ? Moving::travel : Moving::place;
}

/// What moves, at the ends of the motion and between them; SI.
struct Extremes {
  std::string name;
  double start, end, least, most, rate_start, rate_end;
};

std::vector<Extremes> extremes_of(const MotionAnswer& answer, auto&& wanted) {
  const Trajectory& path = answer.found.motion.trajectory;
  const std::size_t last = (path.nodes() - 1) * static_cast<std::size_t>(path.coordinates);
  const MotionRecord& record = answer.record;
  std::vector<Extremes> out;
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    if (!wanted(channel)) continue;
    const auto i = static_cast<std::size_t>(channel.coordinate);
    const double start = path.q[i] + channel.offset, end = path.q[last + i] + channel.offset;
    Extremes row{channel.name, start, end, std::min(start, end), std::max(start, end), path.v[i], path.v[last + i]};
    for (const double value : record.value[c]) {
      row.least = std::min(row.least, value);
      row.most = std::max(row.most, value);
    }
    out.push_back(std::move(row));
  }
  return out;
}

void add_moving(Group& group, const MotionModel& model, const MotionAnswer& answer, Moving kind,
                const std::string& title) {
  const Units& units = model.scene().units;
  const Quantity quantity = kind == Moving::angle ? Quantity::angle : Quantity::length;
  std::vector<Extremes> found =
      extremes_of(answer, [&](const Channel& channel) { return kind_of_channel(model, channel) == kind; });
  if (kind == Moving::angle) found = merge_welded(model.scene(), found);
  Table& table = group.table("", fmt::format("{} ({})", title, unit_name(quantity, units)), Rows::list);
  table.words("", kind == Moving::travel ? "joint" : "body", each(found, &Extremes::name));
  Format format = format_of(model, quantity, coordinate_digits);
  format.scale = in_unit(quantity == Quantity::angle ? M_PI : model.scales().length, quantity, units);
  for (const auto& [name, value] :
       {std::pair("at the start", &Extremes::start), std::pair("at the end", &Extremes::end),
        std::pair("least", &Extremes::least), std::pair("most", &Extremes::most)}) {
    table.numbers("", name, "", in_unit(each(found, value), quantity, units), format);
  }
  table.numbers("", "rate at the end", unit_name(quantity, units) + "/s",
                in_unit(each(found, &Extremes::rate_end), quantity, units), format_of(model, quantity, rate_digits));
}

void add_moving_data(Group& group, const MotionModel& model, const MotionAnswer& answer) {
  for (const auto& [key, kind] : {std::pair("angles", Quantity::angle), std::pair("slides", Quantity::length)}) {
    const Quantity quantity = kind;
    std::vector<Extremes> found;
    if (answer.found.motion.trajectory.nodes() > 0) {
      found = extremes_of(answer, [&](const Channel& c) { return c.quantity == quantity; });
    }
    Table& table = group.table(key, "", Rows::by_name, Verbosity::data);
    table.words("name", "", each(found, &Extremes::name));
    for (const auto& [name, value] :
         {std::pair("start", &Extremes::start), std::pair("end", &Extremes::end), std::pair("least", &Extremes::least),
          std::pair("most", &Extremes::most), std::pair("rate_start", &Extremes::rate_start),
          std::pair("rate_end", &Extremes::rate_end)}) {
      table.data(name, in_unit(each(found, value), quantity, model.scene().units));
    }
  }
}

void add_energies(Group& group, const MotionModel& model, const Motion& motion) {
  std::vector<double> start, end, most;
  for (const std::vector<double>* energy : {&motion.kinetic, &motion.potential, &motion.work}) {
    start.push_back(energy->front());
    end.push_back(energy->back());
    most.push_back(*std::max_element(energy->begin(), energy->end()));
  }
  const Units& units = model.scene().units;
  Table& table = group.table("", fmt::format("Energies ({})", unit_name(Quantity::energy, units)), Rows::list);
  table.words("", "energy", {"kinetic", "potential", "work of all that has no potential"});
  for (const auto& [name, values] :
       {std::pair("at the start", &start), std::pair("at the end", &end), std::pair("most", &most)}) {
    table.numbers("", name, "", in_unit(*values, Quantity::energy, units),
                  format_of(model, Quantity::energy, coordinate_digits - 2));
  }
}

void add_energy_data(Group& group, const MotionModel& model, const Motion& motion) {
  if (motion.kinetic.empty()) {
    group.data("energies", nullptr);
    return;
  }
  Group& energies = group.group("energies", "", Verbosity::data);
  for (const auto& [key, node] : {std::pair("start", std::size_t{0}), std::pair("end", motion.kinetic.size() - 1)}) {
    Group& one = energies.group(key, "", Verbosity::data);
    const auto shown = [&, at = node](const std::vector<double>& energy) {
      return in_unit(energy[at], Quantity::energy, model.scene().units);
    };
    one.data("kinetic", shown(motion.kinetic));
    one.data("potential", shown(motion.potential));
    one.data("work", shown(motion.work));
  }
}

/// The largest effort of each drive, by size, and when.
void add_drives(Group& group, const MotionModel& model, const Motion& motion, Verbosity level) {
  const Scene& scene = model.scene();
  std::vector<std::string> names, efforts;
  std::vector<double> largest, times;
  for (std::size_t d = 0; d < motion.drive_force.size(); ++d) {
    const std::vector<double>& force = motion.drive_force[d];
    const Quantity quantity = effort_of(scene.drives[d].on);
    const auto most = largest_by_size(force);
    const bool any = most != force.end() && *most != 0.0;
    names.push_back(scene.drives[d].name);
    efforts.push_back(with_unit(model, any ? *most : 0.0, quantity));
    largest.push_back(in_unit(any ? *most : 0.0, quantity, scene.units));
    times.push_back(any ? motion.trajectory.t[static_cast<std::size_t>(most - force.begin())] : 0.0);
  }
  Table& table = group.table("drives", "Drives", Rows::list, level);
  table.words("name", "drive", std::move(names));
  table.numbers("largest", "largest force or torque", "", std::move(largest)).texts = std::move(efforts);
  table.numbers("at", "at", "s", std::move(times), {.style = Format::Style::significant});
}

/// The largest force of each blade across its edge, by size, and when.
void add_blades(Group& group, const MotionModel& model, const Motion& motion, Verbosity level) {
  const std::vector<Blade>& blades = model.scene().blades;
  std::vector<double> largest, times;
  for (const std::vector<double>& force : motion.blade_force) {
    const auto most = largest_by_size(force);
    const bool any = most != force.end() && *most != 0.0;
    largest.push_back(any ? *most : 0.0);
    times.push_back(any ? motion.trajectory.t[static_cast<std::size_t>(most - force.begin())] : 0.0);
  }
  Table& table = group.table("blades", "Blades, force across the edge, to its left", Rows::list, level);
  table.words("name", "blade", each(blades, &Blade::name));
  table.words("on", "on", each(blades, [&](const Blade& blade) { return model.scene().name_of(blade.at); }));
  table.numbers("largest", "largest force", "", in_unit(largest, Quantity::force, model.scene().units)).texts =
      each(largest, [&](double force) { return with_unit(model, force, Quantity::force); });
  table.numbers("at", "at", "s", std::move(times), {.style = Format::Style::significant});
}

/// A motion that is not confirmed says so in each row. Outputs of the scene are at the end of each.
void add_record(Group& group, const Scene& scene, const MotionRecord& record, const MotionAnswer& answer) {
  const Units& units = scene.units;
  const QuantitiesInTime& outputs = answer.shown;
  const bool is_confirmed = answer.found.confirmed();
  Table& table = group.table(answer.forces ? "samples" : "", "", Rows::columns, Verbosity::data);
  table.csv = true;
  table.data("time", record.time).unit = "s";
  if (!is_confirmed) table.words("confirmed", "", std::vector<std::string>(record.time.size(), "no"));
  const auto add = [&](const std::string& name, const std::vector<double>& si, Quantity quantity, const char* per) {
    table.data(name, in_unit(si, quantity, units)).unit = unit_name(quantity, units) + per;
  };
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    add(record.channels[c].name, record.value[c], record.channels[c].quantity, "");
  }
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    add(record.channels[c].name + ".rate", record.rate[c], record.channels[c].quantity, "/s");
  }
  for (std::size_t c = 0; c < record.acceleration.size(); ++c) {
    add(record.channels[c].name + ".acceleration", record.acceleration[c], record.channels[c].quantity, "/s²");
  }
  for (const PointRecord& point : record.points) {
    for (const auto& [axis, along] : {std::pair(".x", &Vec2::x), std::pair(".y", &Vec2::y)}) {
      const auto add_part = [&, axis = axis, along = along](const std::vector<Vec2>& of, const char* key,
                                                            const char* per) {
        add(point.name + axis + key, each(of, along), Quantity::length, per);
      };
      add_part(point.place, "", "");
      add_part(point.velocity, ".rate", "/s");
      add_part(point.acceleration, ".acceleration", "/s²");
    }
  }
  add("energy.kinetic", record.kinetic, Quantity::energy, "");
  add("energy.potential", record.potential, Quantity::energy, "");
  if (record.time.empty()) return;
  if (answer.forces) add_force_columns(table, scene, *answer.forces, record.time.size());
  for (std::size_t k = 0; k < outputs.of.size(); ++k) {
    std::vector<double> values = outputs.value[k];
    for (double& one : values) one /= outputs.of[k].dimension.unit(units);
    table.data(outputs.of[k].name, std::move(values)).unit = outputs.of[k].dimension.unit_name(units);
  }
}

/// `states` of controllers are no degrees of freedom of the mechanism.
void add_data(Group& group, const MotionAnswer& answer, int states) {
  const Motion& motion = answer.found.motion;
  group.data("status", to_string(motion.status));
  group.data("why", motion.why);
  group.data("confirmed", answer.found.confirmed());
  group.data("start", answer.start);
  group.data("duration", answer.duration);
  group.data("reached", reached(motion));
  group.data("accuracy", answer.accuracy);
  group.data("error", answer.found.error);
  group.data("energy_error", motion.energy_error);
  group.data("degrees_of_freedom", motion.freedoms - states);
  group.data("steps", motion.steps);
  group.data("rejected", motion.rejected);
  group.data("evaluations", motion.evaluations);
  group.data("microseconds", motion.microseconds);
  group.data("largest_gap", motion.gap);
  group.data("largest_gap_of", motion.gap_of);
  group.data("singular", motion.singular);
}

}  // namespace

Result motion_result(const MotionModel& model, const MotionAnswer& answer, const MotionRecord& measured,
                     const std::vector<std::string>& settings) {
  const Motion& motion = answer.found.motion;
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(model, answer);
  warn_of_contacts(out, model.scene(), motion);
  warn_of_unloaded_bearings(out, model.scene());
  Group& content = out.content;
  const auto states = static_cast<int>(states_of_controllers(model.scene(), model.layout()).size());
  add_data(content, answer, states);
  content.fact("start", answer.start);
  content.fact("mobility",
               fmt::format("{}, of {}", count(motion.freedoms - states, "degree of freedom", "degrees of freedom"),
                           count(model.layout().kept - states, "coordinate that moves", "coordinates that move")));
  if (states > 0) content.fact("control", count(states, "state of controllers", "states of controllers"));
  add_contact_events(content, model, motion);
  add_singular(content, model, motion);
  add_dead_centre(content, motion);
  add_moving_data(content, model, answer);
  add_energy_data(content, model, motion);
  const bool asked = answer.shown.are_all;
  if (!answer.shown.empty()) {
    add_quantities_in_time(content, answer.shown, model, answer.found.error, answer.found.confirmed());
  }
  if (motion.trajectory.nodes() > 0 && !asked) {
    add_moving(content, model, answer, Moving::angle, "Angles");
    add_moving(content, model, answer, Moving::travel, "Slides");
    add_moving(content, model, answer, Moving::place, "Positions of free bodies");
  }
  add_drives(content, model, motion, answer.forces ? Verbosity::data : Verbosity::normal);
  if (!model.scene().blades.empty()) {
    add_blades(content, model, motion, answer.forces ? Verbosity::data : Verbosity::normal);
  }
  if (answer.forces) add_forces_in_time(content, model, *answer.forces);
  if (motion.trajectory.nodes() > 0 && !asked) add_energies(content, model, motion);
  if (!asked) add_record(content, model.scene(), measured, answer);
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("method", effort(motion));
  numerics.fact("error", error_in_words(answer));
  if (!motion.gap_of.empty()) {
    numerics.fact("closure", fmt::format("largest gap of a joint or drive {} of the mechanism's size, or rad: {}",
                                         small_number(motion.gap), motion.gap_of));
  }
  if (answer.forces) {
    numerics.fact("balance", fmt::format("every body is in balance to {} of the largest force, at worst \"{}\"",
                                         small_number(answer.forces->imbalance), answer.forces->worst_body));
    numerics.fact("powers",
                  fmt::format("of drives, loads and elements and the kinetic energy balance to {} of them; "
                              "their integrals, the works and energies, to {}",
                              small_number(answer.forces->power_error), small_number(answer.forces->energy_error)));
  }
  if (answer.shown.imbalance > 0.0) {
    numerics.fact("forces", fmt::format("every body is in balance to {} of the largest force",
                                        small_number(answer.shown.imbalance)));
  }
  numerics.fact("energy", fmt::format("kinetic + potential - work stays within {} of the energy exchanged",
                                      small_number(motion.energy_error)));
  return out;
}

Result no_origin_result(const MotionModel& model, const std::string& why, const std::vector<std::string>& settings) {
  Result out = scene_result(model.scene(), settings);
  out.verdict = bad("No equilibrium found to start from: " + why);
  out.content.fact("remedy", "--from start begins where the scene is assembled");
  return out;
}

}  // namespace poise::app
