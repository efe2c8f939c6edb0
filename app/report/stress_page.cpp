#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/quantity.hpp"
#include "app/report/stress_report.hpp"

namespace poise::app {
namespace {

using comparison::CaseResult;
using comparison::MethodSummary;
using comparison::StressOutcome;

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : one_line(text)) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

std::string row(const std::vector<std::string>& cells) { return fmt::format("| {} |\n", fmt::join(cells, " | ")); }

std::string arrivals(const StressOutcome& outcome) {
  std::vector<std::string> head = {"case", "asked for"}, line = {"---", "---"};
  for (std::size_t k = 1; k <= outcome.methods.size(); ++k) {
    head.push_back(std::to_string(k));
    line.emplace_back("---:");
  }
  std::string out = row(head) + row(line);
  std::string kind;
  for (const CaseResult* result : shown_cases(outcome)) {
    if (result->hard.kind != kind) {
      kind = result->hard.kind;
      std::vector<std::string> cells(head.size());
      cells.front() = "**" + escaped(kind) + "**";
      out += row(cells);
    }
    std::vector<std::string> cells = {escaped(result->hard.name), asked_for(result->hard)};
    for (const comparison::Cell& cell : result->cells) cells.push_back(arrival(cell));
    cells.resize(head.size());
    out += row(cells);
  }
  return out;
}

std::string method_lines(const StressOutcome& outcome) {
  std::string out = row({"", outcome.safeguards ? "virtual work" : "method", "mastered", "wrong", "denied", "inexact",
                         "iterations", "time"}) +
                    row({"---:", "---", "---:", "---:", "---:", "---:", "---:", "---:"});
  int number = 0;
  for (const MethodSummary& s : summaries(outcome)) {
    out += row({std::to_string(++number), s.name, fmt::format("{} of {}", s.mastered, s.taken), std::to_string(s.wrong),
                std::to_string(s.denied), std::to_string(s.inexact), significant(or_gap(s.iterations), 3),
                duration(or_gap(s.microseconds))});
  }
  return out;
}

std::string reasons(const StressOutcome& outcome) {
  std::string out;
  for (const CaseResult& result : outcome.results) {
    if (!result.hard.why.empty()) out += fmt::format("- {}: {}\n", result.hard.name, one_line(result.hard.why));
  }
  return out.empty() ? "" : "\n## Why there is nothing to find\n\n" + out;
}

}  // namespace

std::string stress_markdown(const StressOutcome& outcome, const std::string& command) {
  std::string out =
      outcome.safeguards ? "# What the safeguards of virtual work are worth\n\n" : "# The stress table\n\n";
  out += fmt::format("Made by `{}` from the [hard catalogue](hard-cases.md).", command);
  if (outcome.interrupted) out += fmt::format(" Interrupted: {} of {} cases.", outcome.results.size(), outcome.asked);
  out += outcome.safeguards
             ? "\nCases where one makes a difference: per cent of the seeded starts that arrive, by the number of "
               "the form below.\n"
             : "\nPer cent of the seeded starts that arrive, by the number of the method below; `-`: it refuses the "
               "case.\n";
  out +=
      "`!`: a rest was wrongly claimed. Where a lock is asked for, it arrives who says that the joints lock; where "
      "none,\n"
      "who claims nothing.\n\n";
  out += arrivals(outcome) + "\n" + method_lines(outcome);
  out += fmt::format(
      "\nMastered: cases with an answer in which it arrives from {} % of the starts or more, of those that it takes.\n"
      "Wrong, denied (by the check), inexact (farther off than rounding explains): starts. Iterations and time are\n"
      "medians over cases. ",
      significant(100 * comparison::enough, 4));
  out += outcome.safeguards ? "Forms with something off try no further starts of a case after "
                            : "Methods other than virtual work try no further starts of a case after ";
  out += significant(outcome.seconds, 3) + " s.\n";
  return out + (outcome.safeguards ? "" : reasons(outcome));
}

}  // namespace poise::app
