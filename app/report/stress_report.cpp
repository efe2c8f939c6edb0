#include "app/report/stress_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "app/quantity.hpp"
#include "app/report/parts.hpp"
#include "app/table.hpp"

namespace poise::app {
namespace {

using comparison::CaseResult;
using comparison::Expect;
using comparison::HardCase;
using comparison::MethodSummary;
using comparison::StressFailures;
using comparison::StressOutcome;

// A cell of the same name is one of a table here.
using Tried = comparison::Cell;

Tone tone_of(const HardCase& hard, const Tried& cell) {
  if (cell.wrong > 0) return Tone::bad;
  if (cell.refused) return Tone::faint;
  const bool must = cell.method == Method::virtual_work && hard.expect == Expect::equilibrium;
  return must && !comparison::mastered(cell) ? Tone::doubtful : Tone::plain;
}

std::string verdict(const StressOutcome& outcome, const Palette& palette) {
  const StressFailures failures = failures_of(outcome);
  std::string out;
  if (outcome.interrupted) {
    out += palette.paint(Tone::doubtful, fmt::format("Interrupted in case {} of {}.",
                                                     std::max<std::size_t>(1, outcome.results.size()), outcome.asked)) +
           "\n";
  }
  if (failures.wrong > 0) {
    out += palette.paint(Tone::bad, fmt::format("{} wrongly claimed.", count(failures.wrong, "rest is", "rests are"))) +
           "\n";
  } else if (!outcome.results.empty()) {
    out += palette.paint(Tone::good, "No claim that the check confirms is wrong.") + "\n";
  }
  if (!failures.missed.empty()) {
    out +=
        palette.paint(Tone::doubtful, fmt::format("virtual-work arrives in less than {} % of the starts of {}.",
                                                  significant(100 * comparison::enough, 4), listed(failures.missed))) +
        "\n";
  }
  return out;
}

std::string arrival_table(const StressOutcome& outcome, const Palette& palette) {
  std::vector<Cell> cases, asked;
  std::vector<std::vector<Cell>> columns(outcome.methods.size());
  const auto add_heading = [&](const std::string& kind) {
    cases.push_back({kind, Tone::strong});
    asked.push_back({});
    for (std::vector<Cell>& column : columns) column.push_back({});
  };
  std::string kind;
  for (const CaseResult* result : shown_cases(outcome)) {
    if (result->hard.kind != kind) add_heading(kind = result->hard.kind);
    cases.push_back({"  " + result->hard.name});
    asked.push_back({asked_for(result->hard), Tone::faint});
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (k < result->cells.size()) {
        columns[k].push_back({arrival(result->cells[k]), tone_of(result->hard, result->cells[k])});
      } else {
        columns[k].push_back({});
      }
    }
  }
  if (cases.empty()) return "";
  Table table;
  table.show_all();
  table.add_text_column("case", cases);
  table.add_text_column("asked for", asked);
  for (std::size_t k = 0; k < columns.size(); ++k) table.add_number_cells(std::to_string(k + 1), columns[k]);
  return table.print(palette) +
         palette.paint(Tone::faint,
                       "  !: something was wrongly claimed; -: refused. Asked for locked: said to lock; none: claimed "
                       "nothing") +
         "\n";
}

std::string method_table(const StressOutcome& outcome, const Palette& palette) {
  std::vector<std::string> numbers, names, taken, mastered, iterations, times, denied, inexact;
  std::vector<Cell> wrong;
  for (const MethodSummary& s : summaries(outcome)) {
    numbers.push_back(std::to_string(numbers.size() + 1));
    names.push_back(s.name);
    mastered.push_back(fmt::format("{} of {}", s.mastered, s.taken));
    wrong.push_back({std::to_string(s.wrong), s.wrong > 0 ? Tone::bad : Tone::plain});
    denied.push_back(std::to_string(s.denied));
    inexact.push_back(std::to_string(s.inexact));
    iterations.push_back(significant(or_gap(s.iterations), 3));
    times.push_back(duration(or_gap(s.microseconds)));
  }
  Table table;
  table.add_number_column("", numbers);
  table.add_text_column(outcome.safeguards ? "virtual work" : "method", names);
  table.add_number_column("mastered", mastered);
  table.add_number_cells("wrong", wrong);
  table.add_number_column("denied", denied);
  table.add_number_column("inexact", inexact);
  table.add_number_column("iterations", iterations);
  table.add_number_column("time", times);
  return table.print(palette) +
         palette.paint(Tone::faint,
                       "  mastered: cases with an answer in which it arrives from 99.9 % of the starts or more; of "
                       "those that it takes\n"
                       "  wrong, denied (by the check), inexact (farther off than rounding explains): starts\n"
                       "  iterations, time: medians over cases") +
         "\n";
}

std::string no_answer_section(const StressOutcome& outcome, const Palette& palette) {
  std::string out;
  for (const CaseResult& result : outcome.results) {
    if (result.hard.why.empty()) continue;
    out += fmt::format("  {}: {}\n", result.hard.name, one_line(result.hard.why));
  }
  return section("Why there is nothing to find", out, palette);
}

std::string known_in_words(const HardCase& hard) {
  if (hard.expect == Expect::locked) return "its joints lock: " + hard.why;
  if (hard.expect == Expect::none) return "no rest: " + hard.why;
  if (hard.everywhere) return "it rests everywhere, neutral";
  if (hard.known.empty()) return "no list; answers are refined in 50 digits";
  std::vector<std::string> parts;
  for (const Stability stability : {Stability::stable, Stability::unstable, Stability::neutral, Stability::unknown}) {
    const auto number = std::count_if(hard.known.begin(), hard.known.end(),
                                      [&](const auto& known) { return known.stability == stability; });
    if (number == 0) continue;
    const std::string word = stability == Stability::unknown ? "of unknown stability" : to_string(stability);
    parts.push_back(fmt::format("{} {}", number, word));
  }
  return listed(parts) + (hard.complete ? "; that is all" : "; others are refined in 50 digits");
}

std::string detail_table(const StressOutcome& outcome, const CaseResult& result, const Palette& palette) {
  std::vector<std::string> names, starts, inexact, denied, iterations, times, errors, digits;
  std::vector<Cell> arrived, wrong;
  for (std::size_t k = 0; k < result.cells.size(); ++k) {
    const Tried& cell = result.cells[k];
    const auto number = [&](int value) { return cell.refused ? std::string("-") : std::to_string(value); };
    names.push_back(outcome.methods[k]);
    starts.push_back(number(cell.starts));
    arrived.push_back({arrival(cell), tone_of(result.hard, cell)});
    inexact.push_back(number(cell.inexact));
    wrong.push_back({number(cell.wrong), cell.wrong > 0 ? Tone::bad : Tone::plain});
    denied.push_back(number(cell.denied));
    iterations.push_back(significant(or_gap(cell.iterations), 3));
    times.push_back(duration(or_gap(cell.microseconds)));
    errors.push_back(small_number(or_gap(cell.error)));
    digits.push_back(digits_of(cell.allowed));
  }
  Table table;
  table.add_text_column(outcome.safeguards ? "virtual work" : "method", names);
  table.add_number_column("starts", starts);
  table.add_number_cells("arrived, %", arrived);
  table.add_number_column("inexact", inexact);
  table.add_number_cells("wrong", wrong);
  table.add_number_column("denied", denied);
  table.add_number_column("iterations", iterations);
  table.add_number_column("time", times);
  table.add_number_column("error", errors);
  table.add_number_column("digits", digits);
  return table.print(palette);
}

std::string case_details(const StressOutcome& outcome, const CaseResult& result, const Palette& palette) {
  const HardCase& hard = result.hard;
  std::string out = heading(fmt::format("{}: {}", hard.name, hard.title), hard.source, palette);
  out += fact("asked for", hard.seek == Seek::stable ? "a stable rest" : "the nearest rest", palette);
  out += fact("known", one_line(known_in_words(hard)), palette);
  out += fact("starts",
              fmt::format("every coordinate within {} (rad, or mechanism sizes) of the scene's own start",
                          significant(hard.reach, 3)),
              palette);
  out += "\n" + detail_table(outcome, result, palette);
  std::string words;
  for (std::size_t k = 0; k < result.cells.size(); ++k) {
    const Tried& cell = result.cells[k];
    if (!cell.why.empty()) words += fmt::format("  {}: {}\n", outcome.methods[k], one_line(cell.why));
  }
  return out + (words.empty() ? "" : "\n" + words);
}

}  // namespace

std::string asked_for(const HardCase& hard) {
  if (hard.expect == Expect::locked) return "locked";
  if (hard.expect == Expect::none) return "none";
  return hard.seek == Seek::stable ? "stable" : "nearest";
}

std::string arrival(const comparison::Cell& cell) {
  if (cell.refused) return "-";
  const std::optional<int> tenths = comparison::arrived_tenths(cell);
  if (!tenths) return "";
  std::string text = *tenths % 1000 == 0 ? std::to_string(*tenths / 10) : fmt::format("{:.1f}", 0.1 * *tenths);
  return text + (cell.wrong > 0 ? "!" : "");
}

std::string digits_of(const std::optional<double>& allowed) {
  if (!allowed) return "-";
  return fmt::format("{:.1f}", std::max(0.0, -std::log10(*allowed)));
}

std::string stress_list(const std::vector<HardCase>& cases, const Palette& palette) {
  std::vector<Cell> names, titles, asked, starts;
  std::string kind;
  for (const HardCase& hard : cases) {
    if (hard.kind != kind) {
      names.push_back({kind = hard.kind, Tone::strong});
      for (std::vector<Cell>* column : {&titles, &asked, &starts}) column->push_back({});
    }
    names.push_back({"  " + hard.name});
    titles.push_back({one_line(hard.title)});
    asked.push_back({asked_for(hard)});
    starts.push_back({std::to_string(hard.starts)});
  }
  Table table;
  table.show_all();
  table.add_text_column("case", names);
  table.add_text_column("asked for", asked);
  table.add_number_cells("starts", starts);
  table.add_text_column("what is hard", titles);
  return table.print(palette);
}

std::string stress_overview(const StressOutcome& outcome, const Palette& palette) {
  const std::string arrivals = arrival_table(outcome, palette);
  const std::string differing = outcome.safeguards
                                    ? "Starts that arrive, per cent, where a safeguard makes a difference"
                                    : "Starts that arrive, per cent";
  return verdict(outcome, palette) + section(differing, arrivals, palette) +
         section(outcome.safeguards ? "What each form comes to" : "What each method comes to",
                 method_table(outcome, palette), palette) +
         (outcome.safeguards ? "" : no_answer_section(outcome, palette));
}

std::string stress_details(const StressOutcome& outcome, const Palette& palette) {
  std::string out;
  for (const CaseResult& result : outcome.results) out += case_details(outcome, result, palette) + "\n";
  if (!outcome.results.empty()) {
    out += palette.paint(Tone::faint,
                         "  error: largest of all arrivals from the known rest (rad, or length over mechanism size); "
                         "digits: those that\n  the condition of that rest allows; iterations, time: medians over "
                         "arrivals") +
           "\n\n";
  }
  return out + verdict(outcome, palette);
}

}  // namespace poise::app
