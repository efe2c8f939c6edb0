#include "app/report/work_precision_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "app/report/parts.hpp"
#include "app/table.hpp"
#include "app/work_precision_files.hpp"

namespace poise::app {
namespace {

using comparison::Ending;
using comparison::KnownRest;
using comparison::ToleranceSpan;
using comparison::WorkPrecision;
using comparison::WorkPrecisionRow;

constexpr std::array<double, 4> milestones = {1e-3, 1e-6, 1e-9, 1e-12};

using Spans = std::vector<ToleranceSpan>;

/// "1e-6".
std::string power(double tolerance) {
  std::string text = fmt::format("{:.3g}", tolerance);
  if (text.find('e') == std::string::npos) text = fmt::format("{:.0e}", tolerance);
  const std::size_t zero = text.find("e-0");
  return zero == std::string::npos ? text : text.erase(zero + 2, 1);
}

std::string finders(const KnownRest& rest) {
  constexpr std::size_t most_named = 3;
  if (rest.found_by.empty()) return "met at another tolerance only";
  std::vector<std::string> names;
  for (const Method method : rest.found_by) names.push_back(to_string(method));
  if (names.size() > most_named) {
    const std::size_t more = names.size() - most_named + 1;
    names.resize(most_named - 1);
    names.push_back(fmt::format("{} more methods", more));
  }
  return "met by " + listed(names);
}

std::string known_rests(const WorkPrecision& result, const Palette& palette) {
  std::string out;
  for (const KnownRest& rest : result.rests) {
    std::string text = result.rests.size() > 1 ? fmt::format("{}: ", &rest - result.rests.data() + 1) : "";
    text += rest.stability == Stability::unknown ? "of unknown stability" : to_string(rest.stability);
    text += ", " + finders(rest);
    if (rest.accuracy && std::isfinite(*rest.accuracy)) {
      text += fmt::format("; rounding can move it by {}", small_number(*rest.accuracy));
    }
    if (rest.neutral) text += "; one of a continuum";
    out += fact(out.empty() ? "rests" : "", text, palette);
  }
  return out.empty() ? fact("rests", "none is known in 50 digits, so no error can be told", palette) : out;
}

bool arrived(const ToleranceSpan& span) { return span.loosest->ending == Ending::arrived; }

std::string least_time(const Spans& spans, double error) {
  double least = std::numeric_limits<double>::infinity();
  for (const ToleranceSpan& span : spans) {
    if (arrived(span) && span.loosest->error.value() <= error) least = std::min(least, span.microseconds);
  }
  return std::isfinite(least) ? duration(least) : "-";
}

std::optional<double> least_error(const Spans& spans) {
  std::optional<double> least;
  for (const ToleranceSpan& span : spans) {
    if (arrived(span) && (!least || span.loosest->error.value() < *least)) least = span.loosest->error;
  }
  return least;
}

std::string arrivals(const Spans& spans) {
  std::ptrdiff_t there = 0, all = 0;
  for (const ToleranceSpan& span : spans) {
    const std::ptrdiff_t tolerances = span.tightest - span.loosest + 1;
    all += tolerances;
    if (arrived(span)) there += tolerances;
  }
  return fmt::format("{} of {}", there, all);
}

std::string summary(const std::vector<Spans>& methods, const Palette& palette) {
  std::vector<std::string> names, errors, counts;
  std::array<std::vector<std::string>, milestones.size()> times;
  for (const Spans& spans : methods) {
    names.push_back(to_string(spans.front().loosest->method));
    for (std::size_t m = 0; m < milestones.size(); ++m) times[m].push_back(least_time(spans, milestones[m]));
    errors.push_back(small_number(or_gap(least_error(spans))));
    counts.push_back(arrivals(spans));
  }
  Table table;
  table.add_text_column("method", names);
  for (std::size_t m = 0; m < milestones.size(); ++m) table.add_number_column(power(milestones[m]), times[m]);
  table.add_number_column("best error", errors);
  table.add_number_column("runs arrived", counts);
  return section("Least time to an error below", table.print(palette), palette);
}

Cell status_cell(const WorkPrecisionRow& row) {
  const std::string status = status_of(row);
  if (row.ending == Ending::arrived) return {status, row.confirmed ? Tone::good : Tone::plain};
  return {row.confirmed ? status + ", confirmed" : status, Tone::bad};
}

std::string method_section(const Spans& spans, bool several_rests, const Palette& palette) {
  std::vector<std::string> tolerances, times, errors, iterations, evaluations, rests;
  std::vector<Cell> statuses;
  for (const ToleranceSpan& span : spans) {
    const WorkPrecisionRow& row = *span.loosest;
    tolerances.push_back(power(row.tolerance) +
                         (span.tightest == span.loosest ? "" : " .. " + power(span.tightest->tolerance)));
    times.push_back(duration(span.microseconds));
    errors.push_back(small_number(or_gap(row.error)));
    iterations.push_back(std::to_string(row.iterations));
    evaluations.push_back(std::to_string(row.evaluations));
    rests.push_back(row.rest < 0 ? "-" : std::to_string(row.rest + 1));
    statuses.push_back(status_cell(row));
  }
  Table table;
  table.add_text_column("tolerance", tolerances);
  table.add_number_column("time", times);
  table.add_number_column("error", errors);
  table.add_number_column("iterations", iterations);
  table.add_number_column("evaluations", evaluations);
  if (several_rests) table.add_number_column("rest", rests);
  table.add_text_column("status", statuses);
  std::string body = table.print(palette);
  const auto failed = std::find_if_not(spans.begin(), spans.end(), arrived);
  if (failed != spans.end()) {
    const WorkPrecisionRow& row = *failed->loosest;
    body += palette.paint(Tone::faint, fmt::format("  at {}: {}", power(row.tolerance), row.why)) + "\n";
  }
  const MethodTraits& method = traits(spans.front().loosest->method);
  return section(fmt::format("{}: {}", method.name, method.what), body, palette);
}

}  // namespace

std::string work_precision_report(const StaticModel& model, const WorkPrecision& result,
                                  const comparison::WorkPrecisionOptions& options, const Palette& palette) {
  std::string out = heading(model, palette);
  if (result.interrupted) {
    out += palette.paint(Tone::bad, fmt::format("Interrupted: {} finished.",
                                                count(static_cast<int>(result.rows.size()), "row was", "rows were"))) +
           "\n";
  }
  out += friction_line(model.scene(), palette) + known_rests(result, palette);
  out += fact("time",
              fmt::format("of the search alone, median of {}; more where they take microseconds",
                          count(options.repeats, "run", "runs")),
              palette);
  const std::vector<Spans> methods = tolerance_spans(result);
  out += summary(methods, palette);
  for (const comparison::Refusal& refusal : result.refused) {
    out +=
        palette.paint(Tone::doubtful, fmt::format("  {} refuses: {}", to_string(refusal.method), refusal.why)) + "\n";
  }
  for (const Spans& spans : methods) out += method_section(spans, result.rests.size() > 1, palette);
  if (!methods.empty()) {
    out += "\n" +
           palette.paint(Tone::faint,
                         "  error: largest of all coordinates (rad, or length over size) from the nearest rest\n"
                         "  status: confirmed by the check; claimed by the solver, too coarse for the check") +
           "\n";
  }
  return out + left_out_section(model, palette);
}

}  // namespace poise::app
