#include "app/results/statics/work_precision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "app/present/numbers.hpp"
#include "app/results/parts.hpp"

namespace poise::app {
namespace {

using comparison::Ending;
using comparison::ReferenceEquilibrium;
using comparison::ToleranceSpan;
using comparison::WorkPrecision;
using comparison::WorkPrecisionRow;

using Spans = std::vector<ToleranceSpan>;

constexpr std::array<double, 4> milestones = {1e-3, 1e-6, 1e-9, 1e-12};
constexpr double least_drawn_error = 1e-17;

/// "1e-6".
std::string power(double tolerance) {
  std::string text = fmt::format("{:.3g}", tolerance);
  if (text.find('e') == std::string::npos) text = fmt::format("{:.0e}", tolerance);
  const std::size_t zero = text.find("e-0");
  return zero == std::string::npos ? text : text.erase(zero + 2, 1);
}

bool converged(const ToleranceSpan& span) { return span.loosest->ending == Ending::converged; }

Line verdict(const WorkPrecision& study, const std::vector<Spans>& methods) {
  const auto confirmed = std::count_if(methods.begin(), methods.end(), [](const Spans& spans) {
    return std::any_of(spans.begin(), spans.end(),
                       [](const ToleranceSpan& span) { return converged(span) && span.loosest->confirmed; });
  });
  const std::size_t all = methods.size() + study.not_applicable.size();
  if (confirmed == 0) return {.text = "No run found a confirmed equilibrium.", .tone = Tone::bad};
  return {.text = fmt::format("{} of {} found a confirmed equilibrium.", confirmed,
                              count(static_cast<int>(all), "method", "methods")),
          .tone = Tone::good};
}

std::string finders(const ReferenceEquilibrium& equilibrium) {
  constexpr std::size_t most_named = 3;
  if (equilibrium.found_by.empty()) return "found at another tolerance only";
  std::vector<std::string> names;
  for (const Method method : equilibrium.found_by) names.push_back(to_string(method));
  if (names.size() > most_named) {
    const std::size_t more = names.size() - most_named + 1;
    names.resize(most_named - 1);
    names.push_back(fmt::format("{} more methods", more));
  }
  return "found by " + listed(names);
}

void add_equilibria(Group& content, const StaticModel& model, const WorkPrecision& study) {
  const std::string label = "equilibrium";
  Branch& data = content.array("equilibria");
  for (const ReferenceEquilibrium& known : study.equilibria) {
    std::string text = study.equilibria.size() > 1 ? fmt::format("{}: ", data.parts.size() + 1) : "";
    text += known.stability == Stability::unknown ? "of unknown stability" : to_string(known.stability);
    text += ", " + finders(known);
    if (known.accuracy && std::isfinite(*known.accuracy)) {
      text += fmt::format("; rounding can move it by {}", small_number(*known.accuracy));
    }
    if (known.neutral) text += "; one of a continuum";
    content.fact(label, std::move(text));

    Group& part = data.parts.emplace_back();
    std::vector<std::string> methods, names, units;
    std::vector<double> values;
    for (const Method method : known.found_by) methods.push_back(to_string(method));
    for (std::size_t i = 0; i < known.x.size(); ++i) {
      const Coordinate& c = model.layout().coordinates[i];
      const bool angle = c.kind == Coordinate::Kind::angle;
      names.push_back(c.name);
      units.emplace_back(angle ? "rad" : "m");
      values.push_back(known.x[i] * (angle ? 1.0 : model.scales().length));
    }
    part.data("digits", known.digits);
    part.data("stability", to_string(known.stability));
    part.data("neutral", known.neutral);
    part.data("accuracy", known.accuracy);
    part.data("found_by", std::move(methods));
    Table& coordinates = part.table("coordinates", "", Rows::list);
    coordinates.words("name", "", std::move(names));
    coordinates.words("unit", "", std::move(units));
    coordinates.data("value", std::move(values));
  }
  if (study.equilibria.empty()) content.fact(label, "none is known in 50 digits, so that errors are unknown");
}

/// Microseconds; not a number where no run has so small an error.
double least_time(const Spans& spans, double error) {
  std::optional<double> least;
  for (const ToleranceSpan& span : spans) {
    if (!converged(span) || span.loosest->error.value() > error) continue;
    if (!least || span.microseconds < *least) least = span.microseconds;
  }
  return or_gap(least);
}

double least_error(const Spans& spans) {
  std::optional<double> least;
  for (const ToleranceSpan& span : spans) {
    if (converged(span) && (!least || span.loosest->error.value() < *least)) least = span.loosest->error;
  }
  return or_gap(least);
}

std::string runs_converged(const Spans& spans) {
  std::ptrdiff_t there = 0, all = 0;
  for (const ToleranceSpan& span : spans) {
    const std::ptrdiff_t tolerances = span.tightest - span.loosest + 1;
    all += tolerances;
    if (converged(span)) there += tolerances;
  }
  return fmt::format("{} of {}", there, all);
}

void add_summary(Group& content, const std::vector<Spans>& methods) {
  std::vector<std::string> names, runs;
  std::vector<double> errors;
  for (const Spans& spans : methods) {
    names.push_back(to_string(spans.front().loosest->method));
    errors.push_back(least_error(spans));
    runs.push_back(runs_converged(spans));
  }
  Table& table = content.table("", "Least time to an error below", Rows::list);
  table.words("", "method", std::move(names));
  for (const double milestone : milestones) {
    std::vector<double> times;
    for (const Spans& spans : methods) times.push_back(least_time(spans, milestone));
    table.numbers("", power(milestone), "", std::move(times), {.style = Format::Style::duration});
  }
  table.numbers("", "best error", "", std::move(errors), {.style = Format::Style::error});
  table.counts("", "runs converged", {}).texts = std::move(runs);
}

void add_method(Group& content, const Spans& spans, bool several_equilibria) {
  std::vector<std::string> tolerances, statuses;
  std::vector<double> times, errors, iterations, evaluations, equilibria;
  std::vector<Tone> tones;
  for (const ToleranceSpan& span : spans) {
    const WorkPrecisionRow& row = *span.loosest;
    tolerances.push_back(power(row.tolerance) +
                         (span.tightest == span.loosest ? "" : " .. " + power(span.tightest->tolerance)));
    times.push_back(span.microseconds);
    errors.push_back(or_gap(row.error));
    iterations.push_back(row.iterations);
    evaluations.push_back(row.evaluations);
    equilibria.push_back(row.equilibrium < 0 ? NAN : row.equilibrium + 1);
    // A run that does not converge may be confirmed all the same.
    statuses.push_back(comparison::status_of(row) + (!converged(span) && row.confirmed ? ", confirmed" : ""));
    tones.push_back(!converged(span) ? Tone::bad : row.confirmed ? Tone::good : Tone::plain);
  }
  const MethodTraits& method = traits(spans.front().loosest->method);
  Table& table = content.table("", fmt::format("{}: {}", method.name, method.what), Rows::list);
  table.words("", "tolerance", std::move(tolerances));
  table.numbers("", "time", "", std::move(times), {.style = Format::Style::duration});
  table.numbers("", "error", "", std::move(errors), {.style = Format::Style::error});
  table.counts("", "iterations", std::move(iterations));
  table.counts("", "evaluations", std::move(evaluations));
  table.counts("", "equilibrium", std::move(equilibria)).shown = several_equilibria;
  table.words("", "status", std::move(statuses)).tones = std::move(tones);
  const auto failed = std::find_if_not(spans.begin(), spans.end(), converged);
  if (failed != spans.end()) {
    table.footnotes.push_back(fmt::format("at {}: {}", power(failed->loosest->tolerance), failed->loosest->why));
  }
}

/// Adds the columns of some runs, those of one method without its name.
void add_runs(Table& table, const WorkPrecisionRow* first, const WorkPrecisionRow* end, bool with_method) {
  std::vector<std::string> methods, statuses, whys;
  std::vector<double> tolerances, times, errors, iterations, evaluations, claimed, confirmed, repeats, equilibria;
  for (const WorkPrecisionRow* row = first; row != end; ++row) {
    methods.push_back(to_string(row->method));
    statuses.push_back(comparison::status_of(*row));
    whys.push_back(row->why);
    tolerances.push_back(row->tolerance);
    times.push_back(row->microseconds);
    errors.push_back(or_gap(row->error));
    iterations.push_back(row->iterations);
    evaluations.push_back(row->evaluations);
    claimed.push_back(row->claimed ? 1.0 : 0.0);
    confirmed.push_back(row->confirmed ? 1.0 : 0.0);
    repeats.push_back(row->repeats);
    equilibria.push_back(row->equilibrium < 0 ? NAN : row->equilibrium + 1);
  }
  if (with_method) table.words("method", "", std::move(methods));
  table.words("status", "", std::move(statuses));
  table.data("tolerance", std::move(tolerances));
  table.data("microseconds", std::move(times));
  table.data("error", std::move(errors));
  table.counts("iterations", "", std::move(iterations));
  table.counts("evaluations", "", std::move(evaluations));
  table.flags("claimed", std::move(claimed));
  table.flags("confirmed", std::move(confirmed));
  table.counts("repeats", "", std::move(repeats));
  table.counts("equilibrium", "", std::move(equilibria));
  if (!with_method) table.words("why", "", std::move(whys));
}

void add_data(Group& content, const WorkPrecision& study) {
  std::vector<std::string> methods, whys;
  for (const comparison::NotApplicable& of : study.not_applicable) {
    methods.push_back(to_string(of.method));
    whys.push_back(of.why);
  }
  Table& not_applicable = content.table("does_not_apply", "", Rows::list, Verbosity::data);
  not_applicable.words("method", "", std::move(methods));
  not_applicable.words("why", "", std::move(whys));
  const WorkPrecisionRow* const end = study.rows.data() + study.rows.size();
  Branch& by_method = content.array("methods");
  for (const WorkPrecisionRow* first = study.rows.data(); first != end;) {
    const WorkPrecisionRow* const next =
        std::find_if(first, end, [first](const WorkPrecisionRow& row) { return row.method != first->method; });
    Group& part = by_method.parts.emplace_back();
    part.data("method", to_string(first->method));
    add_runs(part.table("runs", "", Rows::list), first, next, false);
    first = next;
  }
  Table& csv = content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  add_runs(csv, study.rows.data(), end, true);
}

}  // namespace

Result work_precision_result(const StaticModel& model, const WorkPrecision& study, int repeats,
                             const std::vector<std::string>& settings) {
  const std::vector<Spans> methods = comparison::tolerance_spans(study);
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(study, methods);
  if (study.interrupted) {
    out.warnings.push_back({.text = fmt::format("Interrupted: {} finished.",
                                                count(static_cast<int>(study.rows.size()), "row was", "rows were")),
                            .tone = Tone::bad});
  }
  for (const comparison::NotApplicable& of : study.not_applicable) {
    out.warnings.push_back(
        {.text = fmt::format("{} does not apply: {}", to_string(of.method), of.why), .tone = Tone::doubtful});
  }
  warn_of_friction(out, model.scene());
  Group& content = out.content;
  add_equilibria(content, model, study);
  content.fact("time", fmt::format("of the search alone, median of {}; of more where they take microseconds",
                                   count(repeats, "run", "runs")));
  add_summary(content, methods);
  for (const Spans& spans : methods) add_method(content, spans, study.equilibria.size() > 1);
  if (!methods.empty()) {
    content.note("error: largest of all coordinates (rad, or length over size) from the nearest equilibrium",
                 Tone::faint);
    content.note("too coarse: claimed by the solver, not within the bounds of the check", Tone::faint);
  }
  add_data(content, study);
  content.list("left_out", "Left out of statics", model.layout().dropped);
  return out;
}

std::vector<Panel> work_precision_panels(const StaticModel& model, const WorkPrecision& study) {
  const Scene& scene = model.scene();
  Panel panel{.title = scene.title.empty() ? scene.file : scene.title,
              .x_label = "error from the 50-digit reference (rad, or length over size): better to the right",
              .y_label = "median time (µs)",
              .log_x = true,
              .log_y = true,
              .x_falls = true,
              .tall = true};
  std::vector<std::string> absent;
  for (const Spans& spans : comparison::tolerance_spans(study)) {
    const Method method = spans.front().loosest->method;
    Curve curve{.name = to_string(method), .style = Curve::Style::marked, .colour = static_cast<int>(method)};
    for (const ToleranceSpan& span : spans) {
      curve.x.push_back(converged(span) ? std::max(span.loosest->error.value(), least_drawn_error) : NAN);
      curve.y.push_back(converged(span) ? span.microseconds : NAN);
    }
    if (std::any_of(spans.begin(), spans.end(), converged))
      panel.curves.push_back(std::move(curve));
    else
      absent.push_back(to_string(method));
  }
  if (!absent.empty()) panel.title += ": " + listed(absent) + " did not converge";
  return {panel};
}

}  // namespace poise::app
