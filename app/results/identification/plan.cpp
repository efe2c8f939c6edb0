#include "app/results/identification/plan.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"

namespace poise::app {
namespace {

// Of more runs, the standard errors after some of them are shown.
constexpr std::size_t most_steps = 8;

const PlanLimits& limits_of(const FitProblem& problem) { return problem.experiment().plan.value(); }

/// "0.036 per cent".
std::string in_per_cent(double relative) { return significant(100 * relative, 2) + " per cent"; }

std::vector<std::string> not_identifiable(const FitProblem& problem, const PlanStep& step) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < step.standard_error.size(); ++i) {
    if (!std::isfinite(step.standard_error[i])) out.push_back(problem.parameters()[i].name);
  }
  return out;
}

/// "fold.load.P = 37.1 N to ± 0.4 N (standard error)".
std::string prediction_with_error(const PlannedPrediction& of, const PlanStep& step) {
  const std::string unit = of.unit_name.empty() ? "" : " " + of.unit_name;
  return fmt::format("{} = {}{} with a standard error of {}{}", of.name, rounded_to(of.value, step.prediction), unit,
                     significant(step.prediction, 2), unit);
}

Line plan_verdict(const FitProblem& problem, const Plan& plan, const std::optional<PlannedPrediction>& prediction) {
  if (plan.runs.empty()) return bad("No plan: " + plan.why + ".");
  const std::string interrupted = plan.interrupted ? "Interrupted; the best plan so far: " : "";
  const std::string runs =
      interrupted + count(static_cast<int>(plan.runs.size()), "run", "runs") + (plan.interrupted ? "" : " planned");
  const PlanStep& last = plan.steps.back();
  if (!last.ok) return bad(runs + ", but what they determine is not known: " + last.why + ".");
  if (prediction && std::isfinite(last.prediction)) {
    std::string text = fmt::format("{}: {}", runs, prediction_with_error(*prediction, last));
    if (plan.own.ok && std::isfinite(plan.own.prediction)) {
      text += fmt::format("; with the {} of the file {} times as much",
                          count(static_cast<int>(problem.runs()), "run", "runs"),
                          significant(plan.own.prediction / last.prediction, 3));
    }
    return {.text = text + ".", .tone = plan.interrupted ? Tone::doubtful : Tone::good};
  }
  if (prediction) return bad(fmt::format("{}; {} is not determined by them.", runs, prediction->name));
  if (!std::isfinite(last.worst)) {
    return bad(runs + "; not identifiable from them: " + listed(not_identifiable(problem, last)) + ".");
  }
  std::string text = runs + ": the worst standard error is " + in_per_cent(last.worst);
  if (plan.own.ok) {
    const std::string own = count(static_cast<int>(problem.runs()), "run", "runs") + " of the file";
    text += std::isfinite(plan.own.worst)
                ? fmt::format("; with the {}, {}: {} times as large", own, in_per_cent(plan.own.worst),
                              significant(plan.own.worst / last.worst, 3))
                : fmt::format("; the {} do not identify {}", own, listed(not_identifiable(problem, plan.own)));
  }
  return {.text = text + ".", .tone = plan.interrupted ? Tone::doubtful : Tone::good};
}

void add_runs(Group& content, const FitProblem& problem, const ExperimentText& text, const Plan& plan,
              const std::optional<PlannedPrediction>& prediction) {
  const std::vector<PlanChoice>& vary = limits_of(problem).vary;
  const std::vector<std::size_t> rows = places(plan.runs.size());
  Table& table = content.table("", "Planned runs, the most useful first", Rows::list);
  table.shown = Table::Shown::all;
  table.words("", "run", each(rows, [&](std::size_t r) { return text.name_of(r + 1); }));
  if (plan.templates > 1) {
    table.words("", "like", each(plan.runs, [&](const PlannedRun& run) { return text.templates()[run.like]; }));
  }
  for (std::size_t c = 0; c < vary.size(); ++c) {
    table.numbers("", vary[c].what, "", {}).texts =
        each(plan.runs, [&](const PlannedRun& run) { return significant(run.values[c], 6); });
  }
  table.numbers("", "worst standard error, per cent", "", {}).texts = each(rows, [&](std::size_t r) -> std::string {
    const PlanStep& step = plan.steps[r];
    return step.ok && std::isfinite(step.worst) ? significant(100 * step.worst, 2) : "not identifiable";
  });
  if (prediction) {
    table.numbers("", "standard error of " + prediction->name, prediction->unit_name, {}).texts =
        each(rows, [&](std::size_t r) -> std::string {
          const PlanStep& step = plan.steps[r];
          return step.ok && std::isfinite(step.prediction) ? significant(step.prediction, 2) : "not determined";
        });
  }
  table.footnotes = {"errors: after this run and those above; other columns: in the units of the file"};

  Branch& planned = content.array("planned");
  for (std::size_t r = 0; r < plan.runs.size(); ++r) {
    Group& run = planned.parts.emplace_back();
    run.data("name", text.name_of(r + 1));
    run.data("like", text.templates()[plan.runs[r].like]);
    run.data("duration", text.duration(plan.runs[r]));
    Group& values = run.group("values", "", Verbosity::data);
    for (std::size_t c = 0; c < vary.size(); ++c) values.data(vary[c].what, plan.runs[r].values[c]);
  }
}

/// The places of at most `most_steps` of them, the first and the last among them.
std::vector<std::size_t> shown_steps(std::size_t steps) {
  std::vector<std::size_t> out;
  const std::size_t shown = std::min(steps, most_steps);
  for (std::size_t i = 0; i < shown; ++i) out.push_back(shown == steps ? i : i * (steps - 1) / (shown - 1));
  return out;
}

void add_errors(Group& content, const FitProblem& problem, const Plan& plan) {
  const std::vector<std::size_t> rows = places(problem.parameters().size());
  Table& table = content.table("", "Standard errors (Cramer-Rao bound), per cent", Rows::list);
  table.shown = Table::Shown::all;
  table.words("", "parameter", each(rows, [&](std::size_t i) { return problem.parameters()[i].name; }));
  const auto add = [&](const std::string& title, const PlanStep& step) {
    table.numbers("", title, "", {}).texts = each(rows, [&](std::size_t i) -> std::string {
      const double value = problem.parameters()[i].truth + problem.unknown_of(i).includes;
      return step.ok ? per_cent(step.standard_error[i], value) : "-";
    });
  };
  add("runs of the file", plan.own);
  for (const std::size_t k : shown_steps(plan.steps.size())) {
    add(fmt::format("{}{}", k == 0 ? "planned: " : "", k + 1), plan.steps[k]);
  }
}

void add_not_identifiable(Group& content, const PlanStep& last) {
  if (last.not_identifiable.empty() && last.without_run.empty()) return;
  Group& section = content.group("", "Not identifiable from the plan");
  for (const Identifiability::Direction& direction : last.not_identifiable) {
    section.note("  " + direction.words, Tone::bad);
    section.note("    remedy: " + direction.remedy + "; or widen the limits of the plan");
  }
  if (last.without_run.empty()) return;
  section.note("  " + listed(last.without_run) + ": no run of the plan has the label", Tone::bad);
  section.note("    remedy: allow more runs");
}

void add_step_data(Group& out, const FitProblem& problem, const PlanStep& step, std::size_t runs,
                   bool is_for_prediction) {
  out.data("runs", runs);
  out.data("ok", step.ok);
  out.data("why", step.why);
  out.data("worst", step.worst);
  out.data("prediction", is_for_prediction ? Value(step.prediction) : Value());
  out.data("singular_values", step.singular_values);
  Group& errors = out.group("standard_error", "", Verbosity::data);
  for (std::size_t i = 0; i < step.standard_error.size(); ++i) {
    errors.data(problem.parameters()[i].name, step.standard_error[i] / problem.unknown_of(i).unit);
  }
  std::vector<std::string> words;
  for (const Identifiability::Direction& direction : step.not_identifiable) words.push_back(direction.words);
  for (const std::string& name : step.without_run) words.push_back(name + ": no run has its label");
  out.data("not_identifiable", words);
}

}  // namespace

Result plan_result(const FitProblem& problem, const ExperimentText& text, const PlanOptions& options, const Plan& plan,
                   double microseconds, const std::vector<std::string>& settings) {
  const PlanLimits& limits = limits_of(problem);
  Result out = experiment_result(problem, settings);
  out.verdict = plan_verdict(problem, plan, options.prediction);
  Group& content = out.content;
  const char* const criterion = limits.criterion == PlanCriterion::determinant ? "D"
                                : limits.criterion == PlanCriterion::trace     ? "A"
                                                                               : "E";
  content.data("criterion", options.prediction ? "C" : criterion);
  content.data("for", options.prediction ? Value(options.prediction->name) : Value());
  content.data("for_unit", options.prediction ? Value(options.prediction->unit_name) : Value());
  content.data("for_value", options.prediction ? Value(options.prediction->value) : Value());
  content.data("time", limits.time);
  content.data("seed", options.seed);
  content.data("interrupted", plan.interrupted);
  content.data("why", plan.why);
  content.data("candidates", plan.candidates);
  content.data("skipped", plan.skipped);
  content.data("skipped_because", plan.skipped_because);
  content.data("evaluations", plan.evaluations);
  content.data("seconds", microseconds / 1e6);
  if (!plan.runs.empty()) {
    add_runs(content, problem, text, plan, options.prediction);
    add_errors(content, problem, plan);
    add_not_identifiable(content, plan.steps.back());
  }
  add_step_data(content.group("own", "", Verbosity::data), problem, plan.own, problem.runs(),
                options.prediction.has_value());
  Branch& steps = content.array("steps");
  for (std::size_t k = 0; k < plan.steps.size(); ++k) {
    add_step_data(steps.parts.emplace_back(), problem, plan.steps[k], k + 1, options.prediction.has_value());
  }
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("data", data_in_words(problem));
  numerics.fact("criterion",
                options.prediction                               ? "C: the variance of " + options.prediction->name
                : limits.criterion == PlanCriterion::determinant ? "D: the determinant of the relative covariance"
                : limits.criterion == PlanCriterion::trace       ? "A: the sum of the squared relative standard errors"
                                                           : "E: the largest eigenvalue of the relative covariance");
  std::string candidates = count(static_cast<int>(plan.candidates), "candidate", "candidates");
  if (plan.skipped > 0) {
    candidates += fmt::format(", {} of them cannot be made; the first: {}", plan.skipped, plan.skipped_because);
  }
  numerics.fact("candidates", candidates);
  numerics.fact("effort", fmt::format("{} motions with sensitivities, {}", plan.evaluations, duration(microseconds)));
  return out;
}

std::vector<Panel> plan_panels(const FitProblem& problem, const Plan& plan) {
  Panel panel{.title = "Standard errors after so many of the planned runs",
              .x_label = "runs",
              .y_label = "standard error, per cent",
              .log_y = true};
  for (std::size_t i = 0; i < problem.parameters().size(); ++i) {
    const double value = problem.parameters()[i].truth + problem.unknown_of(i).includes;
    Curve curve{.name = problem.parameters()[i].name, .style = Curve::Style::marked, .colour = static_cast<int>(i)};
    bool any = false;
    for (std::size_t k = 0; k < plan.steps.size(); ++k) {
      const double error = plan.steps[k].ok ? 100 * std::abs(plan.steps[k].standard_error[i] / value) : NAN;
      any = any || std::isfinite(error);
      curve.x.push_back(static_cast<double>(k + 1));
      curve.y.push_back(error);
    }
    if (any) panel.curves.push_back(std::move(curve));
  }
  if (panel.curves.empty()) return {};
  if (plan.own.ok && std::isfinite(plan.own.worst)) {
    panel.levels = {{100 * plan.own.worst, "the worst with the runs of the file"}};
  }
  return {std::move(panel)};
}

}  // namespace poise::app
