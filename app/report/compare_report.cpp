#include <limits>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/report/report.hpp"
#include "app/shown_values.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

std::string method_table(const StaticModel& model, const std::vector<Answer>& answers, const Palette& palette) {
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
    errors.push_back(small_number(error_of(answer)));
    stabilities.push_back(rest.found() ? Cell{in_words(rest.check), tone_of(rest.check.stability)} : Cell{"-"});
    energies.push_back(rest.found() ? rest.energy : std::numeric_limits<double>::quiet_NaN());
  }
  Table table;
  table.add_text_column("method", methods);
  table.add_text_column("status", statuses);
  table.add_number_column("iterations", iterations);
  table.add_number_column("evaluations", evaluations);
  table.add_number_column("time", times);
  table.add_number_column("error", errors);
  table.add_text_column("stability", stabilities);
  table.add_number_column(with_unit("energy", Quantity::energy, model.scene().units),
                          aligned(in_units(model, Quantity::energy, energies), coordinate_digits));
  return table.print(palette) +
         palette.paint(Tone::faint,
                       "  error: largest of all coordinates (rad, or length over size) from the 50-digit reference") +
         "\n";
}

std::string agreement_sentence(const StaticModel& model, const std::vector<Answer>& answers, const Palette& palette) {
  const Agreement agreement = compare_answers(model, answers);
  std::string names;
  std::string rests;
  for (const Answer& answer : answers) {
    if (!answer.rest.found()) continue;
    const std::string method = to_string(answer.rest.method);
    names += (names.empty() ? "" : " and ") + method;
    const std::string stability = to_string(answer.rest.check.stability);
    rests += fmt::format("{}{} one that is {}", rests.empty() ? "" : ", ", method,
                         answer.rest.check.stability == Stability::unknown ? "of unknown stability" : stability);
  }
  if (agreement.confirmed == 0) return palette.paint(Tone::bad, "No method found a rest that is confirmed.") + "\n";
  if (agreement.confirmed == 1) return palette.paint(Tone::doubtful, "Only " + names + " found a rest.") + "\n";
  if (agreement.same) {
    const std::string by = agreement.difference == 0.0
                               ? "no coordinate differs"
                               : fmt::format("coordinates differ by {} at most ({})",
                                             small_number(agreement.difference), agreement.coordinate);
    return palette.paint(Tone::good, fmt::format("{} agree: {}{}.", names, by,
                                                 agreement.whole_turns ? ", whole turns of a body aside" : "")) +
           "\n";
  }
  return palette.paint(
             Tone::doubtful,
             fmt::format("The methods found different equilibria: {}. They are {} apart in {} (rad, or length "
                         "over size).",
                         rests, significant(agreement.difference, 3), agreement.coordinate)) +
         "\n";
}

}  // namespace

std::string compare_report(const StaticModel& model, const std::vector<Answer>& answers, const Palette& palette) {
  std::string out = heading(model, palette) + method_table(model, answers, palette) + "\n";
  out += agreement_sentence(model, answers, palette);
  std::vector<const Answer*> shown;
  std::vector<std::string> titles;
  for (const Answer& answer : answers) {
    const std::string method = to_string(answer.rest.method);
    if (!answer.rest.found()) {
      out +=
          palette.paint(Tone::bad, fmt::format("{}, {}: {}.", method, to_string(answer.rest.status), answer.rest.why)) +
          "\n";
    }
    if (!answer.readings) continue;
    shown.push_back(&answer);
    titles.push_back(method + (answer.rest.found() ? "" : ", not at rest"));
  }
  return out + (shown.empty() ? "" : coordinate_sections(model, shown, titles, palette));
}

}  // namespace poise::app
