#include "identification/check_spans.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "identification/first_readings.hpp"

namespace poise {
namespace {

constexpr double most_periods = 1e5, least_periods = 0.01;
constexpr double many_periods = 1e3, least_readings = 2.0;

}  // namespace

void check_spans(const FitProblem& problem) {
  const std::vector<double> starts = problem.starts();
  for (std::size_t r = 0; r < problem.runs(); ++r) {
    const RunModel& model = problem.run(r);
    const Run& run = model.run();
    if (run.is_simulated() || run.time_factor) continue;
    const std::vector<double> unknowns = problem.unknowns_of(r, starts);
    const std::vector<double> nuisances = first_guess(model, unknowns, problem.experiment().records[r]);
    const std::vector<double> begin = model.start_of_run(nuisances);
    const std::vector<double> all = model.natural_frequencies(unknowns.data(), model.equilibrium_at(), begin);
    const auto slowest = std::find_if(all.begin(), all.end(), [](double f) { return f > 0; });
    if (slowest == all.end()) continue;
    const double span = model.span();
    std::size_t readings = 0;
    for (const std::vector<double>& times : model.times()) readings = std::max(readings, times.size());
    const double periods = span * *slowest;
    const bool sparse = static_cast<double>(readings) < least_readings * periods;
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
