#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/report/report.hpp"
#include "app/shown_values.hpp"

namespace poise::app {
namespace {

std::string verdict(const Equilibrium& rest, const Palette& palette) {
  switch (rest.status) {
    case Status::confirmed: {
      const std::string text = rest.check.stability == Stability::unknown
                                   ? "At rest, confirmed; whether it is stable is unknown."
                                   : fmt::format("At rest, confirmed: {}.", to_string(rest.check.stability));
      return palette.paint(tone_of(rest.check.stability), text);
    }
    case Status::refuted:
      return palette.paint(Tone::bad, "Not confirmed: the method claims an equilibrium, the check denies it.");
    case Status::refused:
      return palette.paint(Tone::bad, "Refused: this method cannot answer this scene.");
    case Status::interrupted:
      return palette.paint(Tone::bad, "Interrupted.");
    case Status::not_found:
    case Status::not_solved:
      break;
  }
  return palette.paint(Tone::bad, "Not found.");
}

std::string effort(const Equilibrium& rest) {
  const MethodTraits& method_traits = traits(rest.method);
  const char* sought = method_traits.needs_potential                          ? "a minimum of the energy"
                       : method_traits.minimises || rest.seek == Seek::stable ? "stable rest"
                                                                              : "the nearest rest";
  std::string method = fmt::format("{}, seeking {}", to_string(rest.method), sought);
  if (rest.status == Status::refused) return method;
  return fmt::format("{}: {}, {}, {}", method, count(rest.iterations, "iteration", "iterations"),
                     count(rest.evaluations, "evaluation", "evaluations"), duration(rest.microseconds));
}

std::string residuals(const StaticModel& model, const Check& check) {
  const Units& units = model.scene().units;
  std::string text =
      fmt::format("closure {} {}, imbalance {} {} (largest force {} {})",
                  small_number(in_unit(check.closure_error, Quantity::length, units)), units.length_name,
                  small_number(in_unit(check.imbalance, Quantity::force, units)), units.force_name,
                  significant(in_unit(check.largest_force, Quantity::force, units), 4), units.force_name);
  if (!model.scene().stops.empty()) text += ", stop overrun " + small_number(check.stop_violation);
  return text;
}

std::string accuracy(const Answer& answer) {
  if (!answer.reference) return "not measured: there is no confirmed rest to measure from";
  if (!answer.reference->refined) return "not measured: " + answer.reference->why;
  return small_number(answer.reference->error) + " (rad, or length over size) from the 50-digit reference";
}

/// "good to 13 digits: ...": what the condition of this equilibrium lets anyone know in double precision.
std::string condition(double accuracy) {
  const int digits = std::max(0, static_cast<int>(std::floor(-std::log10(accuracy))));
  return fmt::format("good to {}: rounding may move it by {} (rad, or length over size)",
                     count(digits, "digit", "digits"), small_number(accuracy));
}

/// `"over_centre" at its min, -6 deg`.
std::string pressing_stops(const StaticModel& model, const Answer& answer) {
  const Scene& scene = model.scene();
  std::string text;
  for (const Reaction& reaction : answer.rest.check.reactions) {
    if (reaction.kind != "stop") continue;
    for (std::size_t i = 0; i < scene.stops.size(); ++i) {
      const Stop& stop = scene.stops[i];
      if (stop.name != reaction.name) continue;
      const PressedLimit pressed = pressed_limit(stop, answer.readings->stops[i]);
      const Quantity quantity = quantity_of(stop.on);
      text +=
          fmt::format("{}\"{}\" presses at its {}, {} {}", text.empty() ? "" : "; ", stop.name, pressed.name,
                      significant(in_unit(pressed.value, quantity, scene.units), 6), unit_name(quantity, scene.units));
    }
  }
  return text.empty() ? "none presses" : text;
}

/// "falls along handle +0.94, link -0.33".
std::string leading_directions(const Check& check, const Palette& palette) {
  std::string out;
  for (std::size_t k = 0; k < check.principal_directions.size(); ++k) {
    const int index = static_cast<int>(k);
    if (index >= check.descent_directions + check.neutral_directions) break;
    std::string text = index < check.descent_directions ? "falls along" : "indifferent along";
    const auto& moves = check.principal_directions[k].moves;
    for (const auto& [name, part] : moves) {
      text += fmt::format("{} {} {:+.2f}", &name == &moves.front().first ? "" : ",", name, part);
    }
    out += fact("", text, palette);
  }
  return out;
}

std::string facts(const StaticModel& model, const Answer& answer, const Palette& palette) {
  const Equilibrium& rest = answer.rest;
  const Check& check = rest.check;
  std::string out = fact("method", effort(rest), palette);
  out += fact(rest.found() ? "ended" : "why", rest.why, palette);
  if (!answer.readings) return out;
  out += fact("stability", palette.paint(tone_of(check.stability), in_words(check)), palette);
  out += leading_directions(check, palette);
  if (!check.stability_note.empty()) out += fact("", check.stability_note, palette);
  if (rest.energy && std::isfinite(*rest.energy)) {
    const double energy = in_units(model, Quantity::energy, {*rest.energy}).front();
    out += fact("energy",
                fmt::format("{} {}: {}", significant(energy, coordinate_digits),
                            unit_name(Quantity::energy, model.scene().units), energy_note),
                palette);
  }
  if (!model.scene().stops.empty()) out += fact("stops", pressing_stops(model, answer), palette);
  out += fact("residuals", residuals(model, check), palette);
  out += fact("error", accuracy(answer), palette);
  if (check.accuracy && std::isfinite(*check.accuracy)) {
    out += fact("condition", condition(*check.accuracy), palette);
  }
  return out;
}

}  // namespace

std::string solve_report(const StaticModel& model, const Answer& answer, const Palette& palette) {
  std::string out = heading(model, palette) + verdict(answer.rest, palette) + "\n" +
                    friction_line(model.scene(), palette) + facts(model, answer, palette);
  if (!answer.readings) return out + left_out_section(model, palette);
  const std::string title = answer.rest.found() ? "at rest" : "reached, not at rest";
  out += coordinate_sections(model, {&answer}, {title}, palette);
  out += spring_sections(model, *answer.readings, palette);
  out += reaction_section(model, answer.rest.check.reactions, answer.rest.check.redundancy, palette);
  return out + left_out_section(model, palette);
}

}  // namespace poise::app
