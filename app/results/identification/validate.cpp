#include "app/results/identification/validate.hpp"

#include <cmath>

#include <fmt/format.h>

#include "app/result/numbers.hpp"
#include "app/results/identification/experiment.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

// A held-out error of at most so many times the fit's own, or what a fit of these records leaves, is the model's, not
// that of its parameters.
constexpr double as_good = 1.05;

Line verdict(const Validation& validation) {
  const Fit& fitted = validation.fit;
  if (!fitted.usable()) return bad(fmt::format("No prediction: {}.", fitted.why));
  std::string words =
      fitted.status == FitStatus::converged
          ? "The prediction agrees with the noise"
          : fmt::format("The prediction's error is {} times the noise", significant(fitted.residual_over_noise, 3));
  if (validation.ratio) words += fmt::format(", {} times the identification's", significant(*validation.ratio, 4));
  if (validation.ratio_refitted) {
    words += fmt::format(", {} times that of a fit to these records", significant(*validation.ratio_refitted, 4));
  }
  const auto small = [](const std::optional<double>& ratio) { return ratio && *ratio <= as_good; };
  const bool fine =
      fitted.status == FitStatus::converged || small(validation.ratio) || small(validation.ratio_refitted);
  return fine ? good(words + ".") : doubtful(words + ".");
}

void add_held_out(Group& content, const FitProblem& problem, const Validation& validation) {
  const Fit& fitted = validation.fit;
  const Experiment& experiment = problem.experiment();
  content.data("ratio", validation.ratio);
  content.data("ratio_refitted", validation.ratio_refitted);
  Table& table = content.table("held_out", "Held-out error: root mean squares beside the identification's", Rows::list);
  if (!fitted.usable()) return;
  const std::vector<std::size_t> rows = places(experiment.sensors.size());
  const auto unit = [&](std::size_t k) { return experiment.sensors[k].dimension().unit(experiment.scene.units); };
  const auto add = [&](const std::string& key, const std::string& title, const std::vector<double>& si) {
    table.numbers(key, title, "", each(rows, [&](std::size_t k) { return si[k] / unit(k); }),
                  {.style = Format::Style::significant, .digits = 4});
  };
  table.words("name", "sensor", each(experiment.sensors, [](const Sensor& s) { return one_line(s.name); }));
  add("rms", "held out", fitted.rms);
  add("identification", "identification", validation.identification);
  table.numbers("ratio", "ratio", "",
                each(rows, [&](std::size_t k) { return fitted.rms[k] / validation.identification[k]; }),
                {.style = Format::Style::significant, .digits = 4});
  add("refitted", "fit of these",
      validation.refitted.empty() ? std::vector<double>(rows.size(), NAN) : validation.refitted);
  add("noise", "noise", fitted.weighting.noise);
  add("from_parameters", "from parameters", validation.from_parameters);
  table.words("unit", "unit", each(rows, [&](std::size_t k) {
                return experiment.sensors[k].dimension().unit_name(experiment.scene.units);
              }));
  table.footnotes.emplace_back(
      "fit of these: what a fit of the parameters to these records leaves; from parameters: the part that their "
      "uncertainty explains");
}

void add_parameters(Group& content, const FitProblem& problem, const Validation& validation) {
  const Fit& fitted = validation.fit;
  Table& table = content.table("held", "Parameters, held", Rows::list);
  if (fitted.parameters.empty()) return;
  const std::vector<std::size_t> rows = places(problem.parameters().size());
  const auto unit = [&](std::size_t p) { return problem.unknown_of(p).unit; };
  const auto value = [&](std::size_t p) { return (fitted.parameters[p] + problem.unknown_of(p).includes) / unit(p); };
  const auto error = [&](std::size_t p) {
    const auto at = static_cast<Eigen::Index>(p);
    return std::sqrt(validation.covariance(at, at)) / unit(p);
  };
  table.words("name", "parameter", each(problem.parameters(), &Parameter::name));
  table.numbers("value", "value", "", each(rows, value)).texts =
      each(rows, [&](std::size_t p) { return rounded_to(value(p), error(p)); });
  table.numbers("standard_error", "standard error", "", each(rows, error)).texts =
      each(rows, [&](std::size_t p) { return significant(error(p), 2); });
  table.words("unit", "unit", parameter_units(problem));
}

}  // namespace

Result validation_result(const FitProblem& problem, const Identification& answer, const Validation& validation,
                         const FittedModel& model, Starts starts, const std::vector<std::string>& settings) {
  Result out = experiment_result(problem, settings);
  out.verdict = verdict(validation);
  if (model.is_unfinished) {
    out.warnings.push_back(
        doubtful(fmt::format("The fit of {} was interrupted: its values are no estimates.", model.file)));
  }
  Group& content = out.content;
  content.data("with", model.file);
  content.data("unfinished", model.is_unfinished);
  content.data("starts", starts == Starts::measured ? "measured" : "fitted");
  add_held_out(content, problem, validation);
  add_parameters(content, problem, validation);
  add_residuals(content, problem, answer);
  add_fit_data(content, problem, answer);
  Group& numerics = content.group("", "Numerics", Verbosity::verbose);
  numerics.fact("data", data_in_words(problem));
  numerics.fact("starts", answer.fit.start);
  return out;
}

}  // namespace poise::app
