#include "app/results/identification/compare_models.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "app/results/parts.hpp"
#include "model/one_line.hpp"
#include "solvers/not_a_number.hpp"

namespace poise::app {
namespace {

constexpr int digits_of_scores = 3;

std::string name_of(const FitProblem& problem) {
  const Experiment& experiment = problem.experiment();
  return one_line(experiment.title.empty() ? experiment.file : experiment.title);
}

double rms_over_noise(const FitProblem& problem, const ModelFit& model) {
  return std::sqrt(2 * model.cost / static_cast<double>(problem.readings()));
}

std::vector<std::string> files_of(const std::vector<const FitProblem*>& problems,
                                  const std::vector<std::size_t>& models) {
  return each(models, [&](std::size_t m) { return one_line(problems[m]->experiment().file); });
}

Line verdict(const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  if (answer.interrupted) return bad("Interrupted; the fits that were done are shown.");
  const bool usable =
      std::all_of(answer.models.begin(), answer.models.end(), [](const ModelFit& model) { return model.fit.usable(); });
  const bool held_out = std::isfinite(answer.models[answer.preferred].held_out_all);
  std::string text;
  if (answer.equally_good.empty()) {
    text = fmt::format("Preferred: {}; it {}.", name_of(*problems[answer.preferred]),
                       held_out ? "predicts runs held out best"
                                : "has the best information criterion; no run could be held out of all models");
  } else {
    text = fmt::format("None is preferred: {} explain the readings equally well{}.",
                       fmt::join(files_of(problems, answer.equally_good), " and "),
                       answer.equally_good.size() < answer.models.size() ? ", the others worse" : "");
  }
  return usable ? good(text) : doubtful(text + " Not all fits converged.");
}

void add_models(Group& content, const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  const std::vector<std::size_t> all = places(answer.models.size());
  const auto of = [&](auto&& value) { return each(all, [&](std::size_t m) { return value(m, answer.models[m]); }); };
  Table& table = content.table("models", "Models", Rows::list);
  table.words("title", "model", of([&](std::size_t m, const ModelFit&) { return name_of(*problems[m]); }));
  table.words("file", "", of([&](std::size_t m, const ModelFit&) { return problems[m]->experiment().file; })).shown =
      false;
  table.words("status", "fit", of([&](std::size_t, const ModelFit& model) { return to_string(model.fit.status); }));
  table.counts("parameters", "parameters", of([&](std::size_t m, const ModelFit&) {
                 return static_cast<double>(problems[m]->parameters().size());
               }));
  const auto column = [&](const std::string& key, const std::string& title, auto&& value) {
    const std::vector<double> values = of(value);
    table.numbers(key, title, "", values).texts =
        each(values, [](double x) { return significant(x, digits_of_scores); });
  };
  column("over_noise", "over noise",
         [&](std::size_t m, const ModelFit& model) { return rms_over_noise(*problems[m], model); });
  column("held_out", "held out", [](std::size_t, const ModelFit& model) { return model.held_out_all; });
  column("aic", "AIC more", [](std::size_t, const ModelFit& model) { return model.aic; });
  column("bic", "BIC more", [](std::size_t, const ModelFit& model) { return model.bic; });
  column("loss", "",
         [&](std::size_t m, const ModelFit&) { return answer.loss.empty() ? not_a_number : answer.loss[m]; });
  column("loss_error", "", [&](std::size_t m, const ModelFit&) {
    return answer.loss_error.empty() ? not_a_number : answer.loss_error[m];
  });
  for (Column& one : table.columns) {
    if (one.key == "loss" || one.key == "loss_error") one.shown = false;
  }
  table.footnotes.emplace_back(
      "over noise: root mean square of the residuals; held out: the same of runs that were not fitted, but for their "
      "starts");
  table.footnotes.emplace_back("AIC and BIC more than those of the best model, corrected for correlation");
}

void add_tests(Group& content, const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  Table& table = content.table("tests", "Is the simpler model enough?", Rows::list);
  const auto& tests = answer.tests;
  table.words("simple", "simpler", each(tests, [&](const NestedTest& t) { return name_of(*problems[t.simple]); }));
  table.words("full", "fuller", each(tests, [&](const NestedTest& t) { return name_of(*problems[t.full]); }));
  table.counts("added", "added", each(tests, [](const NestedTest& t) { return static_cast<double>(t.added); }));
  const auto column = [&](const std::string& key, const std::string& title, double NestedTest::*value) {
    const std::vector<double> values = each(tests, [&](const NestedTest& t) { return t.*value; });
    table.numbers(key, title, "", values).texts =
        each(values, [](double x) { return significant(x, digits_of_scores); });
  };
  column("likelihood_ratio", "likelihood ratio", &NestedTest::ratio);
  column("p", "p", &NestedTest::p);
  column("f", "F", &NestedTest::f);
  column("f_p", "p of F", &NestedTest::f_p);
}

void add_runs(Group& content, const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  const std::vector<std::size_t> runs = places(problems.front()->runs());
  Table& table = content.table("", "Runs held out: root mean square over noise", Rows::list);
  table.words("", "run", each(runs, [&](std::size_t r) { return one_line(problems.front()->run(r).run().name); }));
  for (std::size_t m = 0; m < answer.models.size(); ++m) {
    const std::vector<double>& held = answer.models[m].held_out;
    if (held.empty()) continue;
    table.numbers("", fmt::format("model {}", m + 1), "", {}).texts =
        each(runs, [&](std::size_t r) { return significant(held[r], digits_of_scores); });
  }
  table.remarks(each(runs,
                     [&](std::size_t r) {
                       std::vector<std::string> texts;
                       double first = INFINITY;
                       std::size_t best = 0;
                       for (std::size_t m = 0; m < answer.models.size(); ++m) {
                         if (answer.models[m].held_out.size() <= r || !std::isfinite(answer.models[m].held_out[r]))
                           continue;
                         texts.push_back(significant(answer.models[m].held_out[r], digits_of_scores));
                         if (!(answer.models[m].held_out[r] < first)) continue;
                         first = answer.models[m].held_out[r];
                         best = m;
                       }
                       // Not where another is as good in the digits shown.
                       const bool alone =
                           std::count(texts.begin(), texts.end(), significant(first, digits_of_scores)) == 1;
                       return alone ? fmt::format("best by model {}", best + 1) : std::string();
                     }),
                Tone::plain);
  Branch& array = content.array("runs_compared");
  for (const std::size_t r : runs) {
    Group& one = array.parts.emplace_back();
    one.data("name", problems.front()->run(r).run().name);
    std::vector<double> own, held;
    for (const ModelFit& model : answer.models) {
      own.push_back(model.own.empty() ? not_a_number : model.own[r]);
      held.push_back(model.held_out.empty() ? not_a_number : model.held_out[r]);
    }
    one.data("over_noise", own);
    one.data("held_out", held);
  }
}

void add_estimates(Group& content, const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  Branch& array = content.array("fits");
  for (const ModelFit& model : answer.models) {
    const Fit& fitted = model.fit;
    Group& one = array.parts.emplace_back();
    one.data("why", fitted.why);
    Table& table = one.table("estimates", "", Rows::list, Verbosity::data);
    const auto& rows = fitted.estimates;
    table.words("name", "", each(rows, [](const Estimate& e) { return e.name; }));
    table.data("value", each(rows, [](const Estimate& e) { return e.withheld ? not_a_number : e.value / e.unit; }));
    table.data("standard_error",
               each(rows, [](const Estimate& e) { return e.withheld ? not_a_number : e.standard_error / e.unit; }));
  }
  std::vector<std::string> names;
  for (const FitProblem* problem : problems) {
    for (const Parameter& p : problem->parameters()) {
      if (std::find(names.begin(), names.end(), p.name) == names.end()) names.push_back(p.name);
    }
  }
  Table& table = content.table("", "Estimates", Rows::list);
  table.words("", "parameter", names);
  for (std::size_t m = 0; m < answer.models.size(); ++m) {
    table.numbers("", fmt::format("model {}", m + 1), "", {}).texts = each(names, [&](const std::string& name) {
      for (const Estimate& e : answer.models[m].fit.estimates) {
        if (e.name != name) continue;
        if (e.withheld) return std::string("withheld");
        return fmt::format("{} ± {}", rounded_to(e.value / e.unit, e.standard_error / e.unit),
                           significant(e.standard_error / e.unit, 2));
      }
      return std::string("-");
    });
  }
}

}  // namespace

Result compare_models_result(const std::vector<const FitProblem*>& problems, const ModelComparison& answer) {
  Result out;
  out.title = fmt::format("{} models of the same readings", problems.size());
  out.source = problems.front()->experiment().source;
  out.verdict = verdict(problems, answer);
  Group& content = out.content;
  content.data("readings", problems.front()->readings());
  content.data("runs", problems.front()->runs());
  content.data("folds", answer.folds);
  content.data("preferred",
               answer.equally_good.empty() ? Value(problems[answer.preferred]->experiment().file) : Value());
  content.data("equally_good", files_of(problems, answer.equally_good));
  add_models(content, problems, answer);
  if (answer.interrupted) return out;
  add_tests(content, problems, answer);
  add_estimates(content, problems, answer);
  add_runs(content, problems, answer);
  return out;
}

}  // namespace poise::app
