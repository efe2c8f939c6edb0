#include "app/results/statics/stress.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/present/numbers.hpp"

namespace poise::app {
namespace {

using comparison::CaseResult;
using comparison::Cell;
using comparison::Expect;
using comparison::HardCase;
using comparison::StressOutcome;

/// "nearest", "stable", "locked" or "none".
std::string asked_for(const HardCase& hard) {
  if (hard.expect == Expect::locked) return "locked";
  if (hard.expect == Expect::none) return "none";
  return hard.seek == Seek::stable ? "stable" : "nearest";
}

std::string expected(const HardCase& hard) {
  return hard.expect == Expect::equilibrium ? "equilibrium" : asked_for(hard);
}

/// Per cent of the starts that converge, cut to tenths, so that only all are "100" and only none are "0"; "-" where
/// the method does not apply; with "!" behind where it made a false claim.
std::string converged(const Cell& cell) {
  if (!cell.applies) return "-";
  const std::optional<int> tenths = comparison::converged_tenths(cell);
  if (!tenths) return "";
  std::string text = *tenths % 1000 == 0 ? std::to_string(*tenths / 10) : fmt::format("{:.1f}", 0.1 * *tenths);
  return text + (cell.false_claims > 0 ? "!" : "");
}

Tone tone_of(const HardCase& hard, const Cell& cell) {
  if (cell.false_claims > 0) return Tone::bad;
  if (!cell.applies) return Tone::faint;
  const bool must = cell.method == Method::virtual_work && hard.expect == Expect::equilibrium;
  return must && !comparison::solved(cell) ? Tone::doubtful : Tone::plain;
}

void add_verdict(Result& out, const StressOutcome& outcome) {
  const comparison::StressFailures failures = comparison::failures_of(outcome);
  if (failures.false_claims > 0) {
    out.verdict = {.text = fmt::format("{}: confirmed answers that are no equilibrium, or of another stability.",
                                       count(failures.false_claims, "false claim", "false claims")),
                   .tone = Tone::bad};
  } else if (!outcome.results.empty()) {
    out.verdict = {.text = "No false claims.", .tone = Tone::good};
  }
  if (outcome.interrupted) {
    out.warnings.push_back({.text = fmt::format("Interrupted in case {} of {}.",
                                                std::max<std::size_t>(1, outcome.results.size()), outcome.asked),
                            .tone = Tone::doubtful});
  }
  if (!failures.unsolved.empty()) {
    out.warnings.push_back({.text = fmt::format("virtual-work converges from less than {} % of the starts of {}.",
                                                significant(100 * comparison::enough, 4), listed(failures.unsolved)),
                            .tone = Tone::doubtful});
  }
}

/// Rows with a heading over the cases of each kind.
class CaseRows {
 public:
  explicit CaseRows(std::size_t columns) : texts_(columns), tones_(columns) {}

  void add(const HardCase& hard, const std::vector<std::pair<std::string, Tone>>& cells) {
    if (hard.kind != kind_) add_row(kind_ = hard.kind, Tone::strong, {});
    add_row("  " + hard.name, Tone::plain, cells);
  }

  /// Puts them into a table, the columns from `first` to before `end` as numbers, to the right.
  void put_into(Table& table, const std::vector<std::string>& titles, std::size_t first, std::size_t end) {
    table.shown = Table::Shown::all;
    table.words("", "case", names_).tones = name_tones_;
    for (std::size_t c = 0; c < texts_.size(); ++c) {
      if (c < first || c >= end) {
        table.words("", titles[c], texts_[c]).tones = tones_[c];
      } else {
        Column& column = table.counts("", titles[c], {});
        column.texts = texts_[c];
        column.tones = tones_[c];
      }
    }
  }

 private:
  void add_row(const std::string& name, Tone tone, const std::vector<std::pair<std::string, Tone>>& cells) {
    names_.push_back(name);
    name_tones_.push_back(tone);
    for (std::size_t c = 0; c < texts_.size(); ++c) {
      texts_[c].push_back(c < cells.size() ? cells[c].first : "");
      tones_[c].push_back(c < cells.size() ? cells[c].second : Tone::plain);
    }
  }

  std::string kind_;
  std::vector<std::string> names_;
  std::vector<Tone> name_tones_;
  std::vector<std::vector<std::string>> texts_;
  std::vector<std::vector<Tone>> tones_;
};

void add_sheet(Group& group, const StressOutcome& outcome) {
  std::vector<std::string> titles = {"asked for"};
  for (std::size_t k = 1; k <= outcome.methods.size(); ++k) titles.push_back(std::to_string(k));
  CaseRows rows(titles.size());
  for (const CaseResult* result : comparison::shown_cases(outcome)) {
    std::vector<std::pair<std::string, Tone>> cells = {{asked_for(result->hard), Tone::faint}};
    for (const Cell& cell : result->cells) cells.emplace_back(converged(cell), tone_of(result->hard, cell));
    rows.add(result->hard, cells);
  }
  Table& table =
      group.table("",
                  outcome.safeguards ? "Seeded starts that converge, per cent, where a safeguard makes a difference"
                                     : "Seeded starts that converge, per cent",
                  Rows::list);
  rows.put_into(table, titles, 1, titles.size());
  table.footnotes = {
      fmt::format("Columns: numbers of the {} below. !: false claims; -: the method does not apply.",
                  outcome.safeguards ? "forms" : "methods"),
      "Asked for locked: it converges where it says that the joints lock; none: where it claims nothing."};
}

void add_summaries(Group& group, const StressOutcome& outcome) {
  std::vector<std::string> names, solved_of;
  std::vector<double> numbers, solved, false_claims, denied, inexact, iterations, times;
  std::vector<Tone> tones;
  for (const comparison::MethodSummary& s : comparison::summaries(outcome)) {
    numbers.push_back(static_cast<double>(numbers.size() + 1));
    names.push_back(s.name);
    solved.push_back(s.solved);
    solved_of.push_back(fmt::format("{} of {}", s.solved, s.applicable));
    false_claims.push_back(s.false_claims);
    tones.push_back(s.false_claims > 0 ? Tone::bad : Tone::plain);
    denied.push_back(s.denied_by_check);
    inexact.push_back(s.inexact);
    iterations.push_back(or_gap(s.iterations));
    times.push_back(or_gap(s.microseconds));
  }
  Table& table = group.table("", outcome.safeguards ? "Results by form" : "Results by method", Rows::list);
  table.counts("", "", std::move(numbers));
  table.words("", outcome.safeguards ? "virtual work" : "method", std::move(names));
  table.counts("", "solved", std::move(solved)).texts = std::move(solved_of);
  table.counts("", "false claims", std::move(false_claims)).tones = std::move(tones);
  table.counts("", "denied", std::move(denied));
  table.counts("", "inexact", std::move(inexact));
  table.numbers("", "iterations", "", std::move(iterations), {.style = Format::Style::significant, .digits = 3});
  table.numbers("", "time", "", std::move(times), {.style = Format::Style::duration});
  table.footnotes = {
      fmt::format("Solved: cases with an answer in which it converges from {} % of the starts or more, of those to "
                  "which it applies.",
                  significant(100 * comparison::enough, 4)),
      "False claims, denied (by the check), inexact (error larger than rounding explains): starts.",
      fmt::format("Iterations, time: medians over cases. {} try no further starts of a case after {} s.",
                  outcome.safeguards ? "Forms with something off" : "Methods other than virtual work",
                  significant(outcome.seconds, 3))};
}

std::string known_in_words(const HardCase& hard) {
  if (hard.expect == Expect::locked) return "its joints lock: " + hard.why;
  if (hard.expect == Expect::none) return "no equilibrium: " + hard.why;
  if (hard.everywhere) return "every pose is a neutral equilibrium";
  if (hard.known.empty()) return "no list; answers are refined in 50 digits";
  std::vector<std::string> parts;
  for (const Stability stability : {Stability::stable, Stability::unstable, Stability::neutral, Stability::unknown}) {
    const auto number = std::count_if(hard.known.begin(), hard.known.end(),
                                      [&](const auto& known) { return known.stability == stability; });
    if (number == 0) continue;
    const std::string word = stability == Stability::unknown ? "of unknown stability" : to_string(stability);
    parts.push_back(fmt::format("{} {}", number, word));
  }
  return listed(parts) + (hard.complete ? "; a complete list" : "; others are refined in 50 digits");
}

/// What is known of cells, for JSON and CSV: one row for each.
void add_cells(Table& table, const std::vector<std::pair<const Cell*, std::string>>& cells) {
  std::vector<std::string> methods, whys;
  std::vector<double> applies, starts, converged_starts, inexact, false_claims, denied, iterations, times, errors,
      allowed;
  for (const auto& [cell, method] : cells) {
    methods.push_back(method);
    whys.push_back(cell->why);
    applies.push_back(cell->applies ? 1.0 : 0.0);
    starts.push_back(cell->starts);
    converged_starts.push_back(cell->converged);
    inexact.push_back(cell->inexact);
    false_claims.push_back(cell->false_claims);
    denied.push_back(cell->denied_by_check);
    iterations.push_back(or_gap(cell->iterations));
    times.push_back(or_gap(cell->microseconds));
    errors.push_back(or_gap(cell->error));
    allowed.push_back(or_gap(cell->allowed));
  }
  table.words("method", "", std::move(methods));
  table.words("why", "", std::move(whys));
  table.flags("applies", std::move(applies));
  table.counts("starts", "", std::move(starts));
  table.counts("converged", "", std::move(converged_starts));
  table.counts("inexact", "", std::move(inexact));
  table.counts("false_claims", "", std::move(false_claims));
  table.counts("denied_by_check", "", std::move(denied));
  table.data("iterations", std::move(iterations));
  table.data("microseconds", std::move(times));
  table.data("error", std::move(errors));
  table.data("allowed", std::move(allowed));
}

void add_details(Group& content, const StressOutcome& outcome, const CaseResult& result) {
  const HardCase& hard = result.hard;
  Group& group = content.group("", fmt::format("{}: {}", hard.name, one_line(hard.title)));
  group.fact("source", one_line(hard.source));
  group.fact("asked for", hard.seek == Seek::stable ? "a stable equilibrium" : "the nearest equilibrium");
  group.fact("known", one_line(known_in_words(hard)));
  group.fact("starts", fmt::format("every coordinate within {} (rad, or mechanism sizes) of the scene's own start",
                                   significant(hard.reach, 3)));
  std::vector<std::string> methods, percent, digits;
  std::vector<Tone> tones, claim_tones;
  std::vector<double> starts, inexact, false_claims, denied, iterations, times, errors, exact;
  for (std::size_t k = 0; k < result.cells.size(); ++k) {
    const Cell& cell = result.cells[k];
    const auto number = [&](int value) { return cell.applies ? value : NAN; };
    methods.push_back(outcome.methods[k]);
    starts.push_back(number(cell.starts));
    percent.push_back(converged(cell));
    tones.push_back(tone_of(hard, cell));
    inexact.push_back(number(cell.inexact));
    false_claims.push_back(number(cell.false_claims));
    claim_tones.push_back(cell.false_claims > 0 ? Tone::bad : Tone::plain);
    denied.push_back(number(cell.denied_by_check));
    iterations.push_back(or_gap(cell.iterations));
    times.push_back(or_gap(cell.microseconds));
    errors.push_back(or_gap(cell.error));
    digits.push_back(cell.allowed ? fmt::format("{:.1f}", std::max(0.0, -std::log10(*cell.allowed))) : "-");
  }
  Table& table = group.table("", "", Rows::list);
  table.words("", outcome.safeguards ? "virtual work" : "method", std::move(methods));
  table.counts("", "starts", std::move(starts));
  Column& share = table.counts("", "converged, %", {});
  share.texts = std::move(percent);
  share.tones = std::move(tones);
  table.counts("", "inexact", std::move(inexact));
  table.counts("", "false claims", std::move(false_claims)).tones = std::move(claim_tones);
  table.counts("", "denied", std::move(denied));
  table.numbers("", "iterations", "", std::move(iterations), {.style = Format::Style::significant, .digits = 3});
  table.numbers("", "time", "", std::move(times), {.style = Format::Style::duration});
  table.numbers("", "error", "", std::move(errors), {.style = Format::Style::error});
  table.counts("", "digits", {}).texts = std::move(digits);
  for (std::size_t k = 0; k < result.cells.size(); ++k) {
    const Cell& cell = result.cells[k];
    if (!cell.why.empty()) group.fact(outcome.methods[k], one_line(cell.why));
  }
}

void add_data(Group& content, const StressOutcome& outcome) {
  Branch& cases = content.array("cases");
  std::vector<std::string> names, kinds, expects;
  std::vector<std::pair<const Cell*, std::string>> all;
  for (const CaseResult& result : outcome.results) {
    const HardCase& hard = result.hard;
    Group& of_case = cases.parts.emplace_back();
    of_case.data("name", hard.name);
    of_case.data("kind", hard.kind);
    of_case.data("title", hard.title);
    of_case.data("source", hard.source);
    of_case.data("seek", hard.seek == Seek::stable ? "stable" : "nearest");
    of_case.data("expect", expected(hard));
    of_case.data("why", hard.why);
    std::vector<std::pair<const Cell*, std::string>> cells;
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      cells.emplace_back(&result.cells[k], outcome.methods[k]);
      names.push_back(hard.name);
      kinds.push_back(hard.kind);
      expects.push_back(expected(hard));
    }
    add_cells(of_case.table("methods", "", Rows::list), cells);
    all.insert(all.end(), cells.begin(), cells.end());
  }
  Table& csv = content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  csv.words("case", "", std::move(names));
  csv.words("kind", "", std::move(kinds));
  csv.words("expect", "", std::move(expects));
  add_cells(csv, all);
}

}  // namespace

Result stress_list_result(const std::vector<HardCase>& cases) {
  Result out{.title = "Hard cases"};
  CaseRows rows(3);
  for (const HardCase& hard : cases) {
    rows.add(hard, {{asked_for(hard), Tone::plain},
                    {std::to_string(hard.starts), Tone::plain},
                    {one_line(hard.title), Tone::plain}});
  }
  rows.put_into(out.content.table("", "", Rows::list), {"asked for", "starts", "what is hard"}, 1, 2);
  return out;
}

Result stress_result(const StressOutcome& outcome, const std::string& command, bool details) {
  Result out{.title = outcome.safeguards ? "Virtual work with each safeguard switched off" : "Methods on hard cases",
             .source = fmt::format("{}; cases: docs/hard-cases.md", command)};
  add_verdict(out, outcome);
  Group& content = out.content;
  content.data("command", command);
  content.data("interrupted", outcome.interrupted);
  add_data(content, outcome);
  if (details) {
    for (const CaseResult& result : outcome.results) add_details(content, outcome, result);
    content.note("error: largest of the converged starts, from the known equilibrium (rad, or length over size)",
                 Tone::faint);
    content.note("digits: those that its condition allows; iterations, time: medians over converged starts",
                 Tone::faint);
    return out;
  }
  add_sheet(content, outcome);
  add_summaries(content, outcome);
  std::vector<std::string> reasons;
  for (const CaseResult& result : outcome.results) {
    if (!result.hard.why.empty()) reasons.push_back(fmt::format("{}: {}", result.hard.name, one_line(result.hard.why)));
  }
  if (!outcome.safeguards) content.list("", "Cases without an answer", std::move(reasons));
  return out;
}

}  // namespace poise::app
