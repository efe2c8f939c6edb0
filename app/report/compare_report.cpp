#include <algorithm>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/report/report.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"
#include "comparison/agreement.hpp"

namespace poise::app {
namespace {

using comparison::Agreement;

// With more methods than this, coordinates are shown once for each equilibrium.
constexpr std::size_t most_side_by_side = 3;
constexpr std::size_t most_equilibria_shown = 4;

/// The letter of an equilibrium, by which table, sentence and columns name it.
std::string letter(std::size_t equilibrium) { return std::string(1, static_cast<char>('A' + equilibrium)); }

/// "A" of each answer that found an equilibrium, "-" of the others.
std::vector<std::string> letters_of(const std::vector<Answer>& answers, const Agreement& agreement) {
  std::vector<std::string> letters(answers.size(), "-");
  for (std::size_t e = 0; e < agreement.rests.size(); ++e) {
    for (const std::size_t place : agreement.rests[e]) letters[place] = letter(e);
  }
  return letters;
}

/// Whether equilibria go by letters.
bool has_letters(const std::vector<Answer>& answers, const Agreement& agreement) {
  return answers.size() > most_side_by_side && !agreement.same;
}

std::string method_table(const StaticModel& model, const std::vector<Answer>& answers, const Agreement& agreement,
                         const Palette& palette) {
  std::vector<std::string> methods, iterations, evaluations, times, errors;
  std::vector<Cell> statuses, stabilities;
  std::vector<double> energies;
  for (const Answer& answer : answers) {
    const Equilibrium& rest = answer.rest;
    const bool ran = rest.status != Status::refused;
    methods.push_back(to_string(rest.method));
    statuses.push_back({to_string(rest.status), tone_of(rest.status)});
    iterations.push_back(ran ? std::to_string(rest.iterations) : "-");
    evaluations.push_back(ran ? std::to_string(rest.evaluations) : "-");
    times.push_back(ran ? duration(rest.microseconds) : "-");
    errors.push_back(small_number(or_gap(error_of(answer))));
    stabilities.push_back(rest.found() ? Cell{in_words(rest.check), tone_of(rest.check.stability)} : Cell{"-"});
    energies.push_back(or_gap(rest.found() ? rest.energy : std::nullopt));
  }
  Table table;
  table.add_text_column("method", methods);
  table.add_text_column("status", statuses);
  if (has_letters(answers, agreement)) table.add_text_column("rest", letters_of(answers, agreement));
  table.add_number_column("iterations", iterations);
  table.add_number_column("evaluations", evaluations);
  table.add_number_column("time", times);
  table.add_number_column("error", errors);
  table.add_text_column("stability", stabilities);
  table.add_number_column(with_unit("energy", Quantity::energy, model.scene().units),
                          aligned(in_units(model, Quantity::energy, energies), coordinate_digits));
  return table.print(palette) +
         palette.paint(Tone::faint,
                       fmt::format("  error: largest of all coordinates (rad, or length over size) from the 50-digit "
                                   "reference\n  energy: {}",
                                   energy_note)) +
         "\n";
}

std::string kind_of(const Answer& answer) {
  const Stability stability = answer.rest.check.stability;
  return stability == Stability::unknown ? "of unknown stability" : to_string(stability);
}

std::string agreement_sentence(const std::vector<Answer>& answers, const Agreement& agreement, const Palette& palette) {
  std::vector<std::string> names, rests;
  for (std::size_t e = 0; e < agreement.rests.size(); ++e) {
    std::vector<std::string> finders;
    for (const std::size_t place : agreement.rests[e]) finders.push_back(to_string(answers[place].rest.method));
    const std::string who = has_letters(answers, agreement) ? letter(e) + "," : listed(finders);
    rests.push_back(fmt::format("{} one that is {}", who, kind_of(answers[agreement.rests[e].front()])));
    names.insert(names.end(), finders.begin(), finders.end());
  }
  if (agreement.confirmed == 0) return palette.paint(Tone::bad, "No method found a rest that is confirmed.") + "\n";
  if (agreement.confirmed == 1) return palette.paint(Tone::doubtful, "Only " + listed(names) + " found a rest.") + "\n";
  if (agreement.same) {
    const std::string by = agreement.difference == 0.0
                               ? "no coordinate differs"
                               : fmt::format("coordinates differ by {} at most ({})",
                                             small_number(agreement.difference), agreement.coordinate);
    const std::string who = names.size() <= most_side_by_side ? listed(names)
                            : names.size() == answers.size()
                                ? fmt::format("All {} methods", names.size())
                                : fmt::format("The {} of {} methods that found a rest", names.size(), answers.size());
    return palette.paint(Tone::good, fmt::format("{} agree: {}{}.", who, by,
                                                 agreement.whole_turns ? ", whole turns of a body aside" : "")) +
           "\n";
  }
  return palette.paint(
             Tone::doubtful,
             fmt::format("The methods found different equilibria: {}. They are {} apart in {} (rad, or length "
                         "over size).",
                         fmt::join(rests, has_letters(answers, agreement) ? "; " : ", "),
                         significant(agreement.difference, 3), agreement.coordinate)) +
         "\n";
}

/// What stands in the columns of coordinates, and their titles.
struct Columns {
  std::vector<const Answer*> answers;
  std::vector<std::string> titles;
};

Columns columns_of(const std::vector<Answer>& answers, const Agreement& agreement) {
  Columns columns;
  if (answers.size() > most_side_by_side && agreement.confirmed > 0) {
    for (std::size_t e = 0; e < std::min(agreement.rests.size(), most_equilibria_shown); ++e) {
      columns.answers.push_back(&answers[agreement.rests[e].front()]);
      columns.titles.push_back(agreement.same ? "at rest" : letter(e));
    }
    return columns;
  }
  for (const Answer& answer : answers) {
    if (!answer.readings || columns.answers.size() == most_side_by_side) continue;
    columns.answers.push_back(&answer);
    columns.titles.push_back(to_string(answer.rest.method) + (answer.rest.found() ? "" : ", not at rest"));
  }
  return columns;
}

}  // namespace

std::string compare_report(const StaticModel& model, const std::vector<Answer>& answers, const Palette& palette) {
  const Agreement agreement = comparison::compare_answers(model, answers);
  std::string out = heading(model, palette) + method_table(model, answers, agreement, palette) + "\n";
  out += agreement_sentence(answers, agreement, palette);
  for (const Answer& answer : answers) {
    if (answer.rest.found()) continue;
    out += palette.paint(Tone::bad, fmt::format("{}, {}: {}.", to_string(answer.rest.method),
                                                to_string(answer.rest.status), answer.rest.why)) +
           "\n";
  }
  out += friction_line(model.scene(), palette);
  const Columns columns = columns_of(answers, agreement);
  if (!columns.answers.empty()) out += coordinate_sections(model, columns.answers, columns.titles, palette);
  return out + left_out_section(model, palette);
}

}  // namespace poise::app
