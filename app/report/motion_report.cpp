#include "app/report/motion_report.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/motion_files.hpp"
#include "app/report/parts.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

constexpr int rate_digits = 6;
// Errors up to so many times the accuracy asked for need no remark.
constexpr double remarkable = 100.0;

double reached(const Motion& motion) { return motion.trajectory.t.empty() ? 0.0 : motion.trajectory.t.back(); }

std::string verdict(const MotionAnswer& answer, const Palette& palette) {
  const Motion& motion = answer.found.motion;
  if (!motion.completed()) {
    return palette.paint(Tone::bad, fmt::format("Moved for {} s of {} s only: {}.", significant(reached(motion), 6),
                                                significant(answer.duration, 6), motion.why));
  }
  const std::string moved = fmt::format("Moved for {} s", significant(answer.duration, 6));
  if (!answer.found.error) return palette.paint(Tone::bad, moved + "; interrupted before its error was known.");
  if (motion.energy_error >= ConfirmedMotion::useful) {
    return palette.paint(Tone::bad, moved + ", not confirmed: its energy is not in balance.");
  }
  if (!answer.found.confirmed()) {
    return palette.paint(Tone::bad, moved + ", not confirmed: small errors grow to the size of the motion.");
  }
  if (*answer.found.error > remarkable * answer.accuracy || motion.energy_error > remarkable * answer.accuracy) {
    return palette.paint(Tone::doubtful, moved + "; small errors grow along this motion.");
  }
  return palette.paint(Tone::good, moved + ", its energy in balance.");
}

std::string effort(const Motion& motion) {
  std::string text = fmt::format("Runge-Kutta-Fehlberg of order 8: {}", count(motion.steps, "step", "steps"));
  if (motion.rejected > 0) text += fmt::format(", {} rejected", motion.rejected);
  return text +
         fmt::format(", {}, {}", count(motion.evaluations, "evaluation", "evaluations"), duration(motion.microseconds));
}

std::string error(const MotionAnswer& answer) {
  if (!answer.found.error) return "not estimated: the motion did not end";
  return fmt::format("{} of the way each coordinate goes, estimated by a run ten times as accurate (asked for: {})",
                     small_number(*answer.found.error), answer.accuracy);
}

std::string energy_balance(const Motion& motion) {
  return fmt::format("kinetic + potential - work stays within {} of the energy exchanged",
                     small_number(motion.energy_error));
}

std::string singular_poses(const Motion& motion) {
  constexpr std::size_t shown = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(shown, motion.singular.size()); ++i) {
    text += fmt::format("{}{} s", i == 0 ? "passed at t = " : ", ", significant(motion.singular[i], 6));
  }
  if (motion.singular.size() > shown) text += fmt::format(" and {} more", motion.singular.size() - shown);
  return text;
}

std::string facts(const MotionModel& model, const MotionAnswer& answer, const Palette& palette) {
  const Motion& motion = answer.found.motion;
  std::string out = fact("start", answer.start, palette);
  out += fact("freedoms",
              fmt::format("{}, of {}", motion.freedoms,
                          count(model.layout().kept, "coordinate that moves", "coordinates that move")),
              palette);
  out += fact("method", effort(motion), palette);
  out += fact("error", error(answer), palette);
  out += fact("energy", energy_balance(motion), palette);
  if (!motion.singular.empty()) out += fact("singular", singular_poses(motion), palette);
  for (const std::string& stop : motion.overrun) {
    out += fact("stop", palette.paint(Tone::doubtful, "ran through " + stop + ": stops do not act in motion"), palette);
  }
  return out;
}

enum class Moving { angle, travel, place };

Moving kind_of(const MotionModel& model, const Channel& channel) {
  if (channel.quantity == Quantity::angle) return Moving::angle;
  const std::vector<int>& travel = model.layout().travel;
  return std::find(travel.begin(), travel.end(), channel.coordinate) != travel.end() ? Moving::travel : Moving::place;
}

std::string moving_section(const MotionModel& model, const MotionAnswer& answer, Moving kind, const std::string& title,
                           const Palette& palette) {
  const Trajectory& path = answer.found.motion.trajectory;
  const MotionRecord& record = answer.record;
  const std::size_t last = (path.nodes() - 1) * static_cast<std::size_t>(path.coordinates);
  std::vector<std::string> names;
  std::vector<double> start, end, rate, least, most;
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    const Channel& channel = record.channels[c];
    if (kind_of(model, channel) != kind) continue;
    const auto i = static_cast<std::size_t>(channel.coordinate);
    names.push_back(channel.name);
    start.push_back(path.q[i] + channel.offset);
    end.push_back(path.q[last + i] + channel.offset);
    rate.push_back(path.v[last + i]);
    least.push_back(std::min(start.back(), end.back()));
    most.push_back(std::max(start.back(), end.back()));
    for (double value : record.value[c]) {
      least.back() = std::min(least.back(), value);
      most.back() = std::max(most.back(), value);
    }
  }
  if (names.empty()) return "";
  const Units& units = model.scene().units;
  const bool angles = kind == Moving::angle;
  const Quantity quantity = angles ? Quantity::angle : Quantity::length;
  const double scale = in_unit(angles ? M_PI : model.scales().length, quantity, units);
  const auto column = [&](const std::vector<double>& values) {
    return aligned(in_units(model, quantity, values), coordinate_digits, scale);
  };
  Table table;
  table.add_text_column(kind == Moving::travel ? "joint" : "body", names);
  table.add_number_column("at the start", column(start));
  table.add_number_column("at the end", column(end));
  table.add_number_column("least", column(least));
  table.add_number_column("most", column(most));
  table.add_number_column(fmt::format("rate at the end ({}/s)", unit_name(quantity, units)),
                          aligned(in_units(model, quantity, rate), rate_digits));
  return section(with_unit(title, quantity, units), table.print(palette), palette);
}

std::string energy_section(const MotionModel& model, const Motion& motion, const Palette& palette) {
  const std::vector<std::string> names = {"kinetic", "potential", "work of drives, followers and resistances"};
  std::vector<double> start, end, largest;
  for (const std::vector<double>* energy : {&motion.kinetic, &motion.potential, &motion.work}) {
    start.push_back(energy->front());
    end.push_back(energy->back());
    largest.push_back(*std::max_element(energy->begin(), energy->end()));
  }
  Table table;
  table.add_text_column("energy", names);
  const auto column = [&](const std::vector<double>& values) {
    return aligned(in_units(model, Quantity::energy, values), coordinate_digits - 2);
  };
  table.add_number_column("at the start", column(start));
  table.add_number_column("at the end", column(end));
  table.add_number_column("most", column(largest));
  return section(with_unit("Energies", Quantity::energy, model.scene().units), table.print(palette), palette);
}

std::string drive_section(const MotionModel& model, const Motion& motion, const Palette& palette) {
  const Units& units = model.scene().units;
  std::vector<std::string> names, forces, of, times;
  for (std::size_t d = 0; d < motion.drive_force.size(); ++d) {
    const Drive& drive = model.scene().drives[d];
    const Quantity quantity = effort_of(drive.on);
    const LargestForce largest = largest_force(motion, d);
    names.push_back(drive.name);
    forces.push_back(significant(in_units(model, quantity, {largest.value}).front(), force_digits));
    of.push_back(unit_name(quantity, units));
    times.push_back(significant(largest.at, 6));
  }
  if (names.empty()) return "";
  Table table;
  table.add_text_column("drive", names);
  table.add_number_column("largest", forces);
  table.add_text_column("", of);
  table.add_number_column("at (s)", times);
  return section("Drives", table.print(palette), palette);
}

}  // namespace

std::string motion_report(const MotionModel& model, const MotionAnswer& answer, const Palette& palette) {
  std::string out = heading(model, palette) + verdict(answer, palette) + "\n" + facts(model, answer, palette);
  if (answer.found.motion.trajectory.nodes() == 0) return out;
  out += moving_section(model, answer, Moving::angle, "Angles", palette);
  out += moving_section(model, answer, Moving::travel, "Slides", palette);
  out += moving_section(model, answer, Moving::place, "Places of free bodies", palette);
  out += energy_section(model, answer.found.motion, palette);
  return out + drive_section(model, answer.found.motion, palette);
}

}  // namespace poise::app
