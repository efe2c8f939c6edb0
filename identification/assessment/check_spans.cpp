#include "identification/assessment/check_spans.hpp"

#include <algorithm>
#include <optional>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "identification/fit/first_readings.hpp"
#include "model/laws/linear_spring.hpp"

namespace poise {
namespace {

constexpr double most_periods = 1e5, least_periods = 0.01;
constexpr double many_periods = 1e3, least_span_readings = 2.0;

/// The experiment with springs that act in both directions.
Experiment without_slack(Experiment experiment) {
  const auto tighten = [](Scene& scene) {
    for (Element& element : scene.elements) {
      if (auto* spring = std::get_if<LinearSpring>(&element.law)) spring->acts = LinearSpring::Acts::both;
    }
  };
  tighten(experiment.scene);
  for (ExperimentPart& part : experiment.parts) tighten(part.scene);
  return experiment;
}

/// Hz, ascending, at the starts of the parameters in the pose in which run r begins.
std::vector<double> frequencies(const FitProblem& problem, std::size_t r) {
  const RunModel& model = problem.run(r);
  const std::vector<double> unknowns = problem.unknowns_of(r, problem.starts());
  const std::vector<double> nuisances = first_guess(model, unknowns, problem.experiment().records[r]);
  return model.natural_frequencies(unknowns.data(), model.equilibrium_at(), model.start_of_run(nuisances));
}

}  // namespace

void check_spans(const FitProblem& problem) {
  Experiment tight;
  std::optional<FitProblem> tight_problem;
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& model = problem.run(r);
    const Run& run = model.run();
    if (run.is_simulated() || run.is_at_rest() || run.states_time_factor) continue;
    std::vector<double> all = frequencies(problem, r);
    const auto restores = [](double f) { return f > 0; };
    if (std::none_of(all.begin(), all.end(), restores)) {
      if (!tight_problem) {
        tight = without_slack(problem.experiment());
        tight_problem.emplace(tight);
      }
      all = frequencies(*tight_problem, r);
    }
    const auto slowest = std::find_if(all.begin(), all.end(), restores);
    if (slowest == all.end()) continue;
    const double span = model.span();
    std::size_t readings = 0;
    for (const std::vector<double>& times : model.times()) readings = std::max(readings, times.size());
    const double periods = span * *slowest;
    const bool sparse = static_cast<double>(readings) < least_span_readings * periods;
    const bool is_long = periods > most_periods || (periods > many_periods && sparse);
    const bool is_short = span * all.back() < least_periods;
    if (!is_long && !is_short) continue;
    const double f = is_long ? *slowest : all.back();
    throw InputError(
        fmt::format("{}: {}: expected a record in seconds, found {:.3g} s = {:.2g} periods of {:.2g} s in run \"{}\"; "
                    "if the column is "
                    "in {}, add time_factor = {} to the run, if it is in seconds, time_factor = 1",
                    run.data.front().string(), run.time_column, span, span * f, 1 / f, run.name,
                    is_long ? "milliseconds" : "minutes", is_long ? "0.001" : "60"));
  }
}

}  // namespace poise
