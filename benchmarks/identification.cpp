// poise_identification_ratios [DATA.csv]: the speed that identification promises, as one table. Every ratio is of
// programs measured in this run, turn by turn, medians over the turns; no time is printed whose answer is wrong. Exit
// code 1 where an answer is wrong: how fast a machine is today passes or fails nothing. DATA.csv: the measured double
// pendulum (datasets/double_pendulum_experiment.toml says where it comes from); without it these rows are left out.

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "benchmarks/hand_four_bar.hpp"
#include "benchmarks/numeric_fit.hpp"
#include "benchmarks/ratio_table.hpp"
#include "benchmarks/timing.hpp"
#include "benchmarks/yardstick_inputs.hpp"
#include "identification/fit/fit.hpp"
#include "identification/fit/oscillation_start.hpp"

namespace poise::benchmarks {
namespace {

constexpr double sensitivity_limit = 3.0;  // motion with the sensitivities of 4 parameters over the motion alone
constexpr double fit_limit = 8.0;          // six-run fit over one simulation of the six runs
constexpr double numeric_limit = 10.0;     // at least: the fit by numeric differentiation over ours
constexpr double by_hand_limit = 1.4;      // six-run fit over a million four-bars by hand
constexpr double measured_limit = 31.0;    // fit of the measured double pendulum over the same
constexpr double start_off = 0.3;
constexpr int turns = 7;
constexpr int four_bars = 100'000;  // in one turn of the yardstick

/// On one core, as all that these times are compared with.
FitOptions on_one_core() {
  FitOptions options;
  options.jobs = 1;
  return options;
}

std::filesystem::path dataset(const std::string& name) {
  return std::filesystem::path(POISE_SOURCE_DIR) / "datasets" / name;
}

/// Solves the thesis four-bar by hand many times: the yardstick for what has none of its own kind.
class FourBars {
 public:
  void operator()() {
    for (int k = 0; k < four_bars; ++k) result_ = solve_four_bar_by_hand(start_);
  }
  static double million(double seconds) { return 1e6 / four_bars * seconds; }

 private:
  std::array<double, 3> start_ = four_bar_start(StaticModel(thesis_four_bar()));
  HandFourBarResult result_;
};

/// Median seconds of several works, timed in turn.
std::vector<double> race(const std::vector<std::function<void()>>& works, int rounds) {
  std::vector<std::vector<double>> seconds(works.size());
  for (const auto& work : works) work();  // warm caches
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      const std::size_t who = round % 2 == 0 ? i : works.size() - 1 - i;
      seconds[who].push_back(seconds_of(works[who], 1));
    }
  }
  std::vector<double> out;
  for (const auto& own : seconds) out.push_back(median(own));
  return out;
}

/// Both by the same model, from the same state; default accuracy.
void race_sensitivities(RatioTable& table, const FitProblem& problem) {
  const RunModel& run = problem.run(3);  // middle, 200 kg
  const MotionModel model(run.scene());
  const MotionState start = start_motion(model, {{run.independent()[0], false, run.released()[1]}});
  MotionOptions alone;
  alone.duration = 2.0;
  MotionOptions with = alone;
  with.sensitivities = true;
  for (const SceneParameter& number : run.numbers())
    with.influences.push_back(number.influence(run.scene(), model.scales()));
  Motion motion, sensitive;
  const std::vector<double> seconds =
      race({[&] { sensitive = simulate(model, start, with); }, [&] { motion = simulate(model, start, alone); }}, 41);
  const bool right = motion.completed() && sensitive.completed() && difference(motion, sensitive) < 1e-9;
  table.ratio("motion with sensitivities / motion", seconds[0], seconds[1], sensitivity_limit, right,
              fmt::format("{} columns, {}/{} steps", sensitive.trajectory.columns, sensitive.steps, motion.steps));
}

/// Largest difference in standard errors.
double apart(const Fit& reference, const std::vector<double>& parameters) {
  double worst = 0.0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    worst = std::max(worst, std::abs(parameters[i] - reference.parameters[i]) / reference.estimates[i].standard_error);
  }
  return worst;
}

void race_fits(RatioTable& table, const FitProblem& problem) {
  const std::vector<Record> records = problem.records();
  FitOptions by_starts = on_one_core();
  by_starts.use_starts = true;
  double sign = 1.0;
  for (const Parameter& p : problem.parameters()) {
    const Unknown& unknown = problem.experiment().unknowns[static_cast<std::size_t>(p.unknown)];
    by_starts.starts.push_back(p.truth + (sign = -sign) * start_off * (p.truth + unknown.includes));
  }
  Fit automatic, from_starts;
  const std::vector<double> seconds = race({[&] { automatic = fit(problem, records, on_one_core()); },
                                            [&] { from_starts = fit(problem, records, by_starts); },
                                            [&] {
                                              for (std::size_t r = 0; r < problem.runs(); ++r) problem.ideal_record(r);
                                            },
                                            FourBars()},
                                           turns);
  FitOptions strict;
  strict.function_tolerance = 1e-12;
  const Fit reference = fit(problem, records, strict);
  const auto right = [&](const Fit& found) {
    return found.status == FitStatus::converged && apart(reference, found.parameters) < 0.1;
  };
  const auto evaluations = [](const Fit& found) { return fmt::format("{} evaluations", found.evaluations); };
  table.ratio("six-run fit, no start / six simulations", seconds[0], seconds[2], fit_limit, right(automatic),
              evaluations(automatic));
  table.ratio("six-run fit, starts off by 30 % / the same", seconds[1], seconds[2], fit_limit, right(from_starts),
              evaluations(from_starts));
  // Numeric differentiation as it comes, and with motions only as accurate as in our fit and steps to match.
  const double coarse = problem.accuracy(0);
  for (const auto& [setting, how] :
       {std::pair{"", NumericFitOptions{}}, std::pair{", tuned", NumericFitOptions{1e-3, coarse, 1e-7}}}) {
    const auto against = [&, &setting = setting](const std::string& name, const Fit& ours, double our_seconds,
                                                 const std::function<NumericFit()>& theirs) {
      NumericFit numeric;
      const double their_seconds = seconds_of([&] { numeric = theirs(); }, 1);
      const double difference = apart(reference, numeric.parameters);
      // Their results are reported, but not judged here.
      table.speedup(name + setting, our_seconds, their_seconds, numeric_limit, right(ours),
                    fmt::format("{} iterations, differs by {:.1e} standard errors", numeric.iterations, difference));
    };
    against("numeric fit / fit, no start", automatic, seconds[0], [&, &how = how] {
      const auto start = start_from_oscillations(problem, records);
      return fit_numerically(problem, records, start->parameters, start->nuisances, how);
    });
    against("numeric fit / fit, starts off by 30 %", from_starts, seconds[1], [&, &how = how] {
      std::vector<std::vector<double>> nuisances;
      for (std::size_t r = 0; r < problem.runs(); ++r) nuisances.push_back(problem.run(r).released());
      return fit_numerically(problem, records, by_starts.starts, nuisances, how);
    });
  }
  const double million = FourBars::million(seconds[3]);
  table.ratio("six-run fit, no start / 1e6 four-bars", seconds[0], million, by_hand_limit, right(automatic), "");
  table.ratio("six-run fit, off by 30 % / 1e6 four-bars", seconds[1], million, by_hand_limit, right(from_starts), "");
}

void measure_double_pendulum(RatioTable& table, const std::string& name, const std::string& file, double rms_limit,
                             const std::filesystem::path& data) {
  const Experiment experiment = read_experiment(dataset(file), {data, {}});
  const FitProblem problem(experiment);
  const std::vector<Record> records = problem.records();
  Fit found;
  const std::vector<double> seconds = race({[&] { found = fit(problem, records, on_one_core()); }, FourBars()}, 1);
  const double rms =
      found.usable() ? std::sqrt((found.rms[0] * found.rms[0] + found.rms[1] * found.rms[1]) / 2) : INFINITY;
  table.ratio(name + " / 1e6 four-bars", seconds[0], FourBars::million(seconds[1]), measured_limit, rms <= rms_limit,
              fmt::format("rms {:.5f} rad of at most {}, {} evaluations", rms, rms_limit, found.evaluations));
}

bool measure(const std::filesystem::path& data) {
  RatioTable table;
  table.head();
  const Experiment experiment = read_experiment(dataset("lift_experiment.toml"));
  const FitProblem problem(experiment);
  race_sensitivities(table, problem);
  race_fits(table, problem);
  if (data.empty() || !std::filesystem::exists(data)) {
    fmt::print("{:<46}left out: give its CSV file\n", "measured double pendulum");
  } else {
    measure_double_pendulum(table, "double pendulum, viscous", "double_pendulum_experiment.toml", 0.0036, data);
    measure_double_pendulum(table, "double pendulum, viscous and dry", "double_pendulum_dry_experiment.toml", 0.0031,
                            data);
  }
  fmt::print(
      "\nYardsticks: the same motion without sensitivities; one simulation of the six runs at accuracy 1e-10; the\n"
      "same fit with Jacobians by Ceres' central differences, at its default step and our default accuracy, and "
      "tuned:\n"
      "at the accuracy of our own fit, with steps to match; a million solutions of the thesis four-bar by hand.\n");
  return table.all_right();
}

}  // namespace
}  // namespace poise::benchmarks

int main(int argc, char** argv) { return poise::benchmarks::measure(argc > 1 ? argv[1] : "") ? 0 : 1; }
