#include "app/results/statics/stress.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

using comparison::CaseResult;
using comparison::Cell;
using comparison::FrictionCase;
using comparison::FrictionResult;
using comparison::HardCase;
using comparison::KnownAnswer;
using comparison::StressOutcome;

/// "nearest", "stable", "locked" or "none".
std::string asked_for(const HardCase& hard) {
  if (hard.answer == KnownAnswer::locked) return "locked";
  if (hard.answer == KnownAnswer::none) return "none";
  return hard.seek == Seek::stable ? "stable" : "nearest";
}

std::string expected(const HardCase& hard) {
  return hard.answer == KnownAnswer::equilibrium ? "equilibrium" : asked_for(hard);
}

/// Per cent of the starts that converge, cut to tenths, so that only all are "100" and only none are "0"; "-" where
/// the method does not apply; with "!" behind where it made a false claim.
std::string cell_converged(const Cell& cell) {
  if (!cell.applies) return "-";
  const std::optional<int> tenths = comparison::converged_tenths(cell);
  if (!tenths) return "";
  std::string text = *tenths % 1000 == 0 ? std::to_string(*tenths / 10) : fmt::format("{:.1f}", 0.1 * *tenths);
  return text + (cell.false_claims > 0 ? "!" : "");
}

Tone tone_of(const HardCase& hard, const Cell& cell) {
  if (cell.false_claims > 0) return Tone::bad;
  if (!cell.applies) return Tone::faint;
  const bool must = cell.method == Method::virtual_work && hard.answer == KnownAnswer::equilibrium;
  return must && !comparison::solved(cell) ? Tone::doubtful : Tone::plain;
}

void add_verdict(Result& out, const StressOutcome& outcome, const std::vector<FrictionResult>& friction) {
  const comparison::StressFailures failures = comparison::failures_of(outcome);
  const auto wrong = std::count_if(friction.begin(), friction.end(), [](const FrictionResult& r) {
    return !r.agrees && r.pose.verdict != Holding::not_decided;
  });
  if (failures.false_claims > 0) {
    out.verdict = bad(fmt::format("{}: confirmed answers that are no equilibrium, or of another stability.",
                                  count(failures.false_claims, "false claim", "false claims")));
  } else if (wrong > 0) {
    out.verdict =
        bad(fmt::format("{}: of what friction holds.", count(static_cast<int>(wrong), "false claim", "false claims")));
  } else if (!outcome.results.empty() || !friction.empty()) {
    out.verdict = good("No false claims.");
  }
  if (outcome.interrupted) {
    out.warnings.push_back(doubtful(
        fmt::format("Interrupted in case {} of {}.", std::max<std::size_t>(1, outcome.results.size()), outcome.asked)));
  }
  if (!failures.unsolved.empty()) {
    out.warnings.push_back(doubtful(fmt::format("virtual-work converges from less than {} % of the starts of {}.",
                                                significant(100 * comparison::enough, 4), listed(failures.unsolved))));
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
    for (const Cell& cell : result->cells) cells.emplace_back(cell_converged(cell), tone_of(result->hard, cell));
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
      "Asked for locked: a start converges where the method says that the joints lock; none: where it claims nothing."};
}

template <class Row>
Tone tone_of_claims(const Row& row) {
  return row.false_claims > 0 ? Tone::bad : Tone::plain;
}

template <class Row>
void add_costs(Table& table, const std::vector<Row>& rows) {
  table.numbers("", "iterations", "", each(rows, &Row::iterations), {Format::Style::significant, 3});
  table.numbers("", "time", "", each(rows, &Row::microseconds), {Format::Style::duration});
}

void add_summaries(Group& group, const StressOutcome& outcome) {
  using comparison::MethodSummary;
  const std::vector<MethodSummary> rows = comparison::summaries(outcome);
  Table& table = group.table("", outcome.safeguards ? "Results by form" : "Results by method", Rows::list);
  table.counts("", "no.", each(places(rows.size()), [](std::size_t i) { return i + 1; }));
  table.words("", outcome.safeguards ? "virtual work" : "method", each(rows, &MethodSummary::name));
  table.counts("", "solved", each(rows, &MethodSummary::solved)).texts =
      each(rows, [](const MethodSummary& s) { return fmt::format("{} of {}", s.solved, s.applicable); });
  table.counts("", "false claims", each(rows, &MethodSummary::false_claims)).tones =
      each(rows, tone_of_claims<MethodSummary>);
  table.counts("", "denied", each(rows, &MethodSummary::denied_by_check));
  add_costs(table, rows);
  table.footnotes = {
      fmt::format("Solved: cases with an answer in which it converges from {} % of the starts or more, of those to "
                  "which it applies.",
                  significant(100 * comparison::enough, 4)),
      "False claims, denied (claimed by the method, not proved): starts.",
      fmt::format("Iterations, time: medians over cases. {} try no further starts of a case after {}.",
                  outcome.safeguards ? "Forms with something off" : "Methods other than virtual work",
                  outcome.seconds ? fmt::format("{:g} s, as many as this machine does in it", *outcome.seconds)
                                  : fmt::format("{} evaluations of a small mechanism", outcome.work))};
}

std::string verdict_of(Holding verdict) {
  return verdict == Holding::held ? "held" : verdict == Holding::slips ? "slips" : "not decided";
}

std::string expected(const FrictionCase& known) {
  return known.without_end.empty() ? verdict_of(known.verdict) : "held without end";
}

std::string found_in_words(const FrictionResult& result) {
  if (!result.agrees) return verdict_of(result.pose.verdict) + ": " + result.why;
  return expected(result.known) + (result.proved ? ", proved" : ", in double precision");
}

Tone tone_of(const FrictionResult& result) {
  return result.agrees ? (result.proved ? Tone::plain : Tone::doubtful) : Tone::bad;
}

void add_friction(Group& content, const std::vector<FrictionResult>& friction) {
  Table& table = content.table("friction", "Friction that holds", Rows::list);
  table.shown = Table::Shown::all;
  table.words("name", "case", each(friction, [](const FrictionResult& r) { return r.known.name; }));
  table.words("expect", "known", each(friction, [](const FrictionResult& r) { return expected(r.known); }));
  table.words("found", "found", each(friction, found_in_words)).tones =
      each(friction, [](const FrictionResult& r) { return tone_of(r); });
  table.numbers("least_factor", "least factor", "",
                each(friction, [](const FrictionResult& r) { return r.pose.least_factor; }),
                {Format::Style::significant, 10});
  table.flags("agrees", each(friction, [](const FrictionResult& r) { return r.agrees ? 1.0 : 0.0; }));
  table.flags("proved", each(friction, [](const FrictionResult& r) { return r.proved ? 1.0 : 0.0; }));
  table.words("", "what is hard", each(friction, [](const FrictionResult& r) { return one_line(r.known.title); }));
}

std::string known_in_words(const HardCase& hard) {
  if (hard.answer == KnownAnswer::locked) return "its joints lock: " + hard.why;
  if (hard.answer == KnownAnswer::none) return "no equilibrium: " + hard.why;
  if (hard.everywhere) return "every position is a neutral equilibrium";
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

/// What one method made of one case.
struct MethodCell {
  const HardCase* hard;
  const Cell* cell;
  std::string method;
};

/// What is known of cells, for JSON and CSV: one row for each.
void add_cells(Table& table, const std::vector<MethodCell>& rows) {
  const auto of = [&](auto Cell::*member) {
    return each(rows, [&](const MethodCell& row) { return row.cell->*member; });
  };
  table.words("method", "", each(rows, &MethodCell::method));
  table.words("why", "", of(&Cell::why));
  table.flags("applies", of(&Cell::applies));
  table.counts("starts", "", of(&Cell::starts));
  table.counts("converged", "", of(&Cell::converged));
  table.counts("false_claims", "", of(&Cell::false_claims));
  table.counts("denied_by_check", "", of(&Cell::denied_by_check));
  table.data("iterations", of(&Cell::iterations));
  table.data("microseconds", of(&Cell::microseconds));
  table.data("error", of(&Cell::error));
  table.data("allowed", of(&Cell::allowed));
}

void add_details(Group& content, const StressOutcome& outcome, const CaseResult& result) {
  const HardCase& hard = result.hard;
  Group& group = content.group("", fmt::format("{}: {}", hard.name, one_line(hard.title)));
  group.fact("source", one_line(hard.source));
  group.fact("asked for", hard.seek == Seek::stable ? "a stable equilibrium" : "the nearest equilibrium");
  group.fact("known", one_line(known_in_words(hard)));
  group.fact("starts", fmt::format("every coordinate within {} (rad, or mechanism sizes) of the scene's own start",
                                   significant(hard.reach, 3)));
  const std::vector<Cell>& cells = result.cells;
  const auto starts = [&](int Cell::*number) {
    return each(cells, [&](const Cell& cell) { return cell.applies ? cell.*number : NAN; });
  };
  Table& table = group.table("", "", Rows::list);
  table.words("", outcome.safeguards ? "virtual work" : "method", outcome.methods);
  table.counts("", "starts", starts(&Cell::starts));
  Column& share = table.counts("", "converged, %", {});
  share.texts = each(cells, cell_converged);
  share.tones = each(cells, [&](const Cell& cell) { return tone_of(hard, cell); });
  table.counts("", "false claims", starts(&Cell::false_claims)).tones = each(cells, tone_of_claims<Cell>);
  table.counts("", "denied", starts(&Cell::denied_by_check));
  add_costs(table, cells);
  table.numbers("", "error", "", each(cells, &Cell::error), {Format::Style::error});
  table.counts("", "digits", {}).texts = each(cells, [](const Cell& cell) {
    return cell.allowed ? fmt::format("{:.1f}", std::max(0.0, -std::log10(*cell.allowed))) : "-";
  });
  for (std::size_t k = 0; k < result.cells.size(); ++k) {
    const Cell& cell = result.cells[k];
    if (!cell.why.empty()) group.fact(outcome.methods[k], one_line(cell.why));
  }
}

void add_data(Group& content, const StressOutcome& outcome) {
  Branch& cases = content.array("cases");
  std::vector<MethodCell> all;
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
    std::vector<MethodCell> cells;
    for (std::size_t k = 0; k < result.cells.size(); ++k) {
      cells.push_back({&hard, &result.cells[k], outcome.methods[k]});
    }
    add_cells(of_case.table("methods", "", Rows::list), cells);
    all.insert(all.end(), cells.begin(), cells.end());
  }
  Table& csv = content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  csv.words("case", "", each(all, [](const MethodCell& row) { return row.hard->name; }));
  csv.words("kind", "", each(all, [](const MethodCell& row) { return row.hard->kind; }));
  csv.words("expect", "", each(all, [](const MethodCell& row) { return expected(*row.hard); }));
  add_cells(csv, all);
}

}  // namespace

Result stress_list_result(const std::vector<HardCase>& cases, const std::vector<FrictionCase>& friction) {
  Result out{.title = "Hard cases"};
  CaseRows rows(3);
  for (const HardCase& hard : cases) {
    rows.add(hard, {{asked_for(hard), Tone::plain},
                    {std::to_string(hard.starts), Tone::plain},
                    {one_line(hard.title), Tone::plain}});
  }
  rows.put_into(out.content.table("", "", Rows::list), {"asked for", "starts", "what is hard"}, 1, 2);
  Table& held = out.content.table("", "Friction that holds", Rows::list);
  held.shown = Table::Shown::all;
  held.words("", "case", each(friction, &FrictionCase::name));
  held.words("", "known", each(friction, [](const FrictionCase& known) { return expected(known); }));
  held.words("", "what is hard", each(friction, [](const FrictionCase& known) { return one_line(known.title); }));
  return out;
}

Result stress_result(const StressOutcome& outcome, const std::vector<FrictionResult>& friction,
                     const std::string& command, bool details) {
  Result out{.title = outcome.safeguards ? "Virtual work with each safeguard switched off" : "Methods on hard cases",
             .source = fmt::format("{}; cases: docs/hard-cases.md", command)};
  add_verdict(out, outcome, friction);
  Group& content = out.content;
  content.data("command", command);
  content.data("interrupted", outcome.interrupted);
  add_data(content, outcome);
  if (details) {
    for (const CaseResult& result : outcome.results) add_details(content, outcome, result);
    add_friction(content, friction);
    if (outcome.results.empty()) return out;
    content.note("error: largest of the converged starts, from the known equilibrium (rad, or length over size)",
                 Tone::faint);
    content.note("digits: those that its condition allows; iterations, time: medians over converged starts",
                 Tone::faint);
    return out;
  }
  content.note(outcome.safeguards
                   ? "Virtual work is started with all its safeguards, and with each of them switched off in turn."
                   : "Every method is started from many random starts on cases that are hard and have a known answer.");
  content.note("A start converges where it reaches the known answer and that is proved.");
  add_sheet(content, outcome);
  add_friction(content, friction);
  add_summaries(content, outcome);
  std::vector<std::string> reasons;
  for (const CaseResult& result : outcome.results) {
    if (!result.hard.why.empty()) reasons.push_back(fmt::format("{}: {}", result.hard.name, one_line(result.hard.why)));
  }
  if (!outcome.safeguards) content.list("", "Cases without an answer", std::move(reasons));
  return out;
}

}  // namespace poise::app
