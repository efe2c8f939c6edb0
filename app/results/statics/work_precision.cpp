#include "app/results/statics/work_precision.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
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
  if (confirmed == 0) return bad("No run found a confirmed equilibrium.");
  return good(fmt::format("{} of {} found a confirmed equilibrium.", confirmed,
                          count(static_cast<int>(all), "method", "methods")));
}

std::vector<std::string> names_of(const std::vector<Method>& methods) {
  return each(methods, [](Method method) { return to_string(method); });
}

std::string finders(const ReferenceEquilibrium& equilibrium) {
  constexpr std::size_t most_named = 3;
  if (equilibrium.found_by.empty()) return "found at another tolerance only";
  std::vector<std::string> names = names_of(equilibrium.found_by);
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
    text += fmt::format("; rounding of the scene's numbers can move it by {}", small_number(known.rounding_effect));
    if (known.neutral) text += "; one of a continuum";
    content.fact(label, std::move(text));

    Group& part = data.parts.emplace_back();
    part.data("digits", known.digits);
    part.data("stability", to_string(known.stability));
    part.data("neutral", known.neutral);
    part.data("rounding_effect", known.rounding_effect);
    part.data("found_by", names_of(known.found_by));
    add_coordinate_names(part.table("coordinates", "", Rows::list), model.layout(), known.x.size())
        .data("value", model.to_si(known.x));
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
  Table& table = content.table("", "Least time to an error below", Rows::list);
  table.words("", "method", each(methods, [](const Spans& s) { return to_string(s.front().loosest->method); }));
  for (const double milestone : milestones) {
    table.numbers("", power(milestone), "", each(methods, [&](const Spans& s) { return least_time(s, milestone); }),
                  {Format::Style::duration});
  }
  table.numbers("", "best error", "", each(methods, least_error), {Format::Style::error});
  table.counts("", "runs converged", {}).texts = each(methods, runs_converged);
  for (const Spans& spans : methods) {
    const auto failed = std::find_if_not(spans.begin(), spans.end(), converged);
    if (failed == spans.end()) continue;
    table.footnotes.push_back(fmt::format("{} at {}: {}", to_string(failed->loosest->method),
                                          power(failed->loosest->tolerance), failed->loosest->why));
  }
}

/// The number of the equilibrium that a run is nearest to, from 1.
double number_of_run(const WorkPrecisionRow& run) { return run.equilibrium < 0 ? NAN : run.equilibrium + 1; }

void add_method(Group& content, const Spans& spans, bool several_equilibria) {
  const auto tolerance = [](const ToleranceSpan& s) {
    return power(s.loosest->tolerance) + (s.tightest == s.loosest ? "" : " .. " + power(s.tightest->tolerance));
  };
  // A run that does not converge may be confirmed all the same.
  const auto status = [](const ToleranceSpan& s) {
    return comparison::status_of(*s.loosest) + (!converged(s) && s.loosest->confirmed ? ", confirmed" : "");
  };
  const MethodTraits& method = traits(spans.front().loosest->method);
  Table& table = content.table("", fmt::format("{}: {}", method.name, method.what), Rows::list, Verbosity::verbose);
  table.words("", "tolerance", each(spans, tolerance));
  table.numbers("", "time", "", each(spans, &ToleranceSpan::microseconds), {Format::Style::duration});
  table.numbers("", "error", "", each(spans, [](const ToleranceSpan& s) { return s.loosest->error; }),
                {Format::Style::error});
  table.counts("", "iterations", each(spans, [](const ToleranceSpan& s) { return s.loosest->iterations; }));
  table.counts("", "evaluations", each(spans, [](const ToleranceSpan& s) { return s.loosest->evaluations; }));
  table.counts("", "equilibrium", each(spans, [](const ToleranceSpan& s) { return number_of_run(*s.loosest); })).shown =
      several_equilibria;
  table.words("", "status", each(spans, status)).tones = each(spans, [](const ToleranceSpan& s) {
    return !converged(s) ? Tone::bad : s.loosest->confirmed ? Tone::good : Tone::plain;
  });
}

/// Adds the columns of some runs, those of one method without its name.
void add_runs(Table& table, std::span<const WorkPrecisionRow> runs, bool with_method) {
  if (with_method) table.words("method", "", each(runs, [](const auto& run) { return to_string(run.method); }));
  table.words("status", "", each(runs, comparison::status_of));
  table.data("tolerance", each(runs, &WorkPrecisionRow::tolerance));
  table.data("microseconds", each(runs, &WorkPrecisionRow::microseconds));
  table.data("error", each(runs, &WorkPrecisionRow::error));
  table.counts("iterations", "", each(runs, &WorkPrecisionRow::iterations));
  table.counts("evaluations", "", each(runs, &WorkPrecisionRow::evaluations));
  table.flags("claimed", each(runs, &WorkPrecisionRow::claimed));
  table.flags("confirmed", each(runs, &WorkPrecisionRow::confirmed));
  table.counts("repeats", "", each(runs, &WorkPrecisionRow::repeats));
  table.counts("equilibrium", "", each(runs, number_of_run));
  if (!with_method) table.words("why", "", each(runs, &WorkPrecisionRow::why));
}

void add_data(Group& content, const WorkPrecision& study) {
  Table& not_applicable = content.table("does_not_apply", "", Rows::list, Verbosity::data);
  not_applicable.words("method", "", each(study.not_applicable, [](const auto& of) { return to_string(of.method); }));
  not_applicable.words("why", "", each(study.not_applicable, &comparison::NotApplicable::why));
  Branch& by_method = content.array("methods");
  for (auto first = study.rows.begin(); first != study.rows.end();) {
    const auto next =
        std::find_if(first, study.rows.end(), [&](const auto& row) { return row.method != first->method; });
    Group& part = by_method.parts.emplace_back();
    part.data("method", to_string(first->method));
    add_runs(part.table("runs", "", Rows::list), {first, next}, false);
    first = next;
  }
  Table& csv = content.table("", "", Rows::list, Verbosity::data);
  csv.csv = true;
  add_runs(csv, study.rows, true);
}

}  // namespace

Result work_precision_result(const StaticModel& model, const WorkPrecision& study, int repeats,
                             const std::vector<std::string>& settings) {
  const std::vector<Spans> methods = comparison::tolerance_spans(study);
  Result out = scene_result(model.scene(), settings);
  out.verdict = verdict(study, methods);
  if (study.interrupted) {
    out.warnings.push_back(bad(
        fmt::format("Interrupted: {} finished.", count(static_cast<int>(study.rows.size()), "row was", "rows were"))));
  }
  for (const comparison::NotApplicable& of : study.not_applicable) {
    out.warnings.push_back(doubtful(fmt::format("{} does not apply: {}", to_string(of.method), of.why)));
  }
  warn_of_friction(out, model.scene());
  warn_of_blades(out, model.scene());
  Group& content = out.content;
  add_equilibria(content, model, study);
  content.fact("time", fmt::format("of the search alone, median of {}; of more where they take microseconds",
                                   count(repeats, "run", "runs")));
  add_summary(content, methods);
  for (const Spans& spans : methods) add_method(content, spans, study.equilibria.size() > 1);
  if (!methods.empty()) {
    content.note("error: largest of all coordinates (rad, or length over size) from the nearest equilibrium",
                 Tone::faint);
    content.note("too coarse: claimed by the solver, too far from an equilibrium for a proof", Tone::faint);
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
