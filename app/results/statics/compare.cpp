#include "app/results/statics/compare.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/parts.hpp"
#include "app/results/statics/settling.hpp"
#include "app/results/statics/solve.hpp"
#include "comparison/agreement.hpp"

namespace poise::app {
namespace {

using comparison::Agreement;

// With more methods than this, positions are shown once for each equilibrium.
constexpr std::size_t most_side_by_side = 3;
constexpr std::size_t most_equilibria_shown = 4;

/// The letter of an equilibrium, by which table, sentence and columns name it.
std::string letter(std::size_t equilibrium) { return std::string(1, static_cast<char>('A' + equilibrium)); }

/// "A" of each answer that found an equilibrium, "-" of the others.
std::vector<std::string> letters_of(const std::vector<Answer>& answers, const Agreement& agreement) {
  std::vector<std::string> letters(answers.size(), "-");
  for (std::size_t e = 0; e < agreement.equilibria.size(); ++e) {
    for (const std::size_t place : agreement.equilibria[e]) letters[place] = letter(e);
  }
  return letters;
}

/// Whether equilibria go by letters.
bool has_letters(const std::vector<Answer>& answers, const Agreement& agreement) {
  return answers.size() > most_side_by_side && !agreement.same;
}

void add_methods(Group& group, const StaticModel& model, const std::vector<Answer>& answers,
                 const Agreement& agreement) {
  const Units& units = model.scene().units;
  const auto if_run = [](auto Equilibrium::*number) {
    return [number](const Answer& a) {
      return a.equilibrium.status == Status::not_applicable ? NAN : static_cast<double>(a.equilibrium.*number);
    };
  };
  const auto energy = [&](const Answer& a) {
    return in_unit(or_gap(a.equilibrium.found() ? a.equilibrium.energy : std::nullopt), Quantity::energy, units);
  };
  Table& table = group.table("", "Methods", Rows::list);
  table.words("", "method", each(answers, [](const Answer& a) { return to_string(a.equilibrium.method); }));
  table.words("", "status", each(answers, [](const Answer& a) { return to_string(a.equilibrium.status); })).tones =
      each(answers, [](const Answer& a) { return tone_of(a.equilibrium.status); });
  if (has_letters(answers, agreement)) table.words("", "equilibrium", letters_of(answers, agreement));
  table.counts("", "iterations", each(answers, if_run(&Equilibrium::iterations)));
  table.counts("", "evaluations", each(answers, if_run(&Equilibrium::evaluations)));
  table.numbers("", "time", "", each(answers, if_run(&Equilibrium::microseconds)), {Format::Style::duration});
  table.numbers("", "error", "", each(answers, error_of), {Format::Style::error});
  table
      .words("", "stability",
             each(answers,
                  [](const Answer& a) { return a.equilibrium.found() ? in_words(a.equilibrium.certificate) : "-"; }))
      .tones = each(answers, [](const Answer& a) {
    return a.equilibrium.found() ? tone_of(a.equilibrium.certificate.stability) : Tone::plain;
  });
  table.numbers("", "energy", unit_name(Quantity::energy, units), each(answers, energy),
                format_of_energies(model, answers));
  table.footnotes = {
      "error: largest of all coordinates (rad, or length over size), from the equilibrium that is proved",
      fmt::format("energy: {}", energy_note)};
}

/// How far apart two equilibria are, in the unit of the coordinate in which they differ most.
std::string distance(const StaticModel& model, const Agreement& agreement) {
  const std::vector<Coordinate>& coordinates = model.layout().coordinates;
  const auto found = std::find_if(coordinates.begin(), coordinates.end(),
                                  [&](const Coordinate& c) { return c.name == agreement.coordinate; });
  const bool angle = found == coordinates.end() || found->kind == Coordinate::Kind::angle;
  return angle ? with_unit(model, agreement.difference, Quantity::angle, 4)
               : with_unit(model, agreement.difference * model.scales().length, Quantity::length, 4);
}

Line verdict(const StaticModel& model, const std::vector<Answer>& answers, const Agreement& agreement) {
  std::vector<std::string> names, equilibria;
  for (std::size_t e = 0; e < agreement.equilibria.size(); ++e) {
    std::vector<std::string> finders;
    for (const std::size_t place : agreement.equilibria[e])
      finders.push_back(to_string(answers[place].equilibrium.method));
    const std::string who = has_letters(answers, agreement) ? letter(e) : listed(finders);
    equilibria.push_back(fmt::format("{}: {}", who, kind_of(answers[agreement.equilibria[e].front()])));
    names.insert(names.end(), finders.begin(), finders.end());
  }
  if (agreement.confirmed == 0) return bad("No method found a confirmed equilibrium.");
  if (agreement.confirmed == 1) {
    return doubtful("Only " + listed(names) + " found an equilibrium.");
  }
  if (!agreement.same) {
    return doubtful(fmt::format("The methods found different equilibria: {}. Largest difference: {} in {}.",
                                fmt::join(equilibria, "; "), distance(model, agreement), agreement.coordinate));
  }
  const std::string by = agreement.difference == 0.0
                             ? "no coordinate differs"
                             : fmt::format("coordinates differ by {} at most ({})", small_number(agreement.difference),
                                           agreement.coordinate);
  const std::string who =
      names.size() <= most_side_by_side ? listed(names)
      : names.size() == answers.size()
          ? fmt::format("All {} methods", names.size())
          : fmt::format("The {} of {} methods that found an equilibrium", names.size(), answers.size());
  return good(fmt::format("{} agree: {}{}.", who, by, agreement.whole_turns ? ", whole turns of a body aside" : ""));
}

void add_positions(Group& group, const StaticModel& model, const std::vector<Answer>& answers,
                   const Agreement& agreement) {
  std::vector<const Readings*> poses;
  std::vector<std::string> titles;
  double radius = 0.0;
  const auto add = [&](const Answer& answer, const std::string& title) {
    poses.push_back(&*answer.readings);
    titles.push_back(title);
    radius = std::max(radius, radius_of(answer.equilibrium));
  };
  if (answers.size() > most_side_by_side && agreement.confirmed > 0) {
    for (std::size_t e = 0; e < std::min(agreement.equilibria.size(), most_equilibria_shown); ++e) {
      add(answers[agreement.equilibria[e].front()], agreement.same ? "equilibrium" : letter(e));
    }
  } else {
    for (const Answer& answer : answers) {
      if (!answer.readings || poses.size() == most_side_by_side) continue;
      add(answer, to_string(answer.equilibrium.method) + (answer.equilibrium.found() ? "" : ", no equilibrium"));
    }
  }
  add_coordinates(group, model, poses, titles, radius);
}

}  // namespace

Result compare_result(const StaticModel& model, const std::vector<Answer>& answers,
                      const std::vector<std::string>& settings) {
  const Agreement agreement = comparison::compare_answers(model, answers);
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(model, answers, agreement);
  for (const Answer& answer : answers) {
    if (answer.equilibrium.found()) continue;
    out.warnings.push_back(bad(fmt::format("{}, {}: {}.", to_string(answer.equilibrium.method),
                                           to_string(answer.equilibrium.status), answer.equilibrium.why)));
  }
  warn_of_shaky(out, "At the end of", answers,
                each(answers, [](const Answer& a) { return to_string(a.equilibrium.method); }));
  warn_of_friction(out, model.scene());
  warn_of_blades(out, model.scene());
  Group& content = out.content;
  // Every method was given the same settled pose.
  show_settling(out, model, answers.front().equilibrium);
  add_methods(content, model, answers, agreement);
  Branch& methods = content.array("methods");
  for (const Answer& answer : answers) add_answer_data(methods.parts.emplace_back(), model, answer);
  if (agreement.confirmed < 2) {
    content.data("agreement", nullptr);
  } else {
    Group& data = content.group("agreement", "", Verbosity::data);
    data.data("same", agreement.same);
    data.data("largest_difference", agreement.difference);
  }
  add_positions(content, model, answers, agreement);
  content.list("left_out", "Left out of statics", model.layout().dropped);
  return out;
}

}  // namespace poise::app
