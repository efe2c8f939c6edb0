#include "identification/assessment/monte_carlo.hpp"

#include <atomic>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::monte_carlo_test {
namespace {

// Six runs of the lift: the estimates reach the Cramer-Rao bound and the intervals have their nominal coverage. For 120
// trials the ratio scatters by 0.065, and the coverage by 0.02; the seed is fixed.
TEST(MonteCarlo, LiftReachesItsBounds) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  MonteCarloOptions options;
  constexpr int trials = 120;
  options.trials = trials;
  options.seed = 2;
  options.use_starts = false;
  const MonteCarlo found = monte_carlo(problem, options);
  EXPECT_EQ(found.trials, trials);
  EXPECT_EQ(found.converged, trials);
  EXPECT_EQ(found.near_truth, trials);
  EXPECT_FALSE(found.interrupted);
  EXPECT_NEAR(found.residual_over_noise, 1.0, 0.002);
  EXPECT_LE(found.evaluations, 6.0);
  ASSERT_EQ(found.parameters.size(), 4U);
  for (const TrialStatistics& s : found.parameters) {
    SCOPED_TRACE(s.name);
    EXPECT_GT(s.rmse / s.bound, 0.89);
    EXPECT_LT(s.rmse / s.bound, 1.11);
    EXPECT_GE(s.coverage, 0.92);
    EXPECT_LE(s.coverage, 0.98);
    EXPECT_LT(std::abs(s.bias), 4 * s.bound / std::sqrt(trials));
  }
}

TEST(MonteCarlo, LiftConvergesFromStartsThatDifferByHalf) {
  const Experiment e = test::experiment("lift_experiment");
  const FitProblem problem(e);
  MonteCarloOptions options;
  options.trials = 40;
  options.seed = 11;
  const MonteCarlo found = monte_carlo(problem, options);
  EXPECT_EQ(found.trials, 40);
  EXPECT_EQ(found.converged, 40);
  EXPECT_EQ(found.near_truth, 40);
}

// Two runs with few readings, from which stiffness and damping are identifiable: quick.
Experiment small() {
  Experiment e = test::experiment("lift_experiment");
  e.unknowns.erase(e.unknowns.begin(), e.unknowns.begin() + 2);
  e.runs.resize(2);
  for (poise::Run& run : e.runs) run.sample_rate = 100;
  return e;
}

TEST(MonteCarlo, DoesNotDependOnTheThreads) {
  const Experiment e = small();
  const FitProblem problem(e);
  MonteCarloOptions options;
  options.trials = 6;
  options.study.jobs = 1;
  const MonteCarlo alone = monte_carlo(problem, options);
  options.study.jobs = 3;
  const MonteCarlo shared = monte_carlo(problem, options);
  EXPECT_EQ(alone.trials, 6);
  EXPECT_EQ(alone.converged, shared.converged);
  EXPECT_EQ(alone.residual_over_noise, shared.residual_over_noise);
  EXPECT_EQ(alone.evaluations, shared.evaluations);
  for (std::size_t i = 0; i < alone.parameters.size(); ++i) {
    EXPECT_EQ(alone.parameters[i].bias, shared.parameters[i].bias);
    EXPECT_EQ(alone.parameters[i].rmse, shared.parameters[i].rmse);
    EXPECT_EQ(alone.parameters[i].coverage, shared.parameters[i].coverage);
  }
  options.seed = 2;
  EXPECT_NE(monte_carlo(problem, options).residual_over_noise, shared.residual_over_noise);
}

TEST(MonteCarlo, KeepsFinishedTrialsWhenInterrupted) {
  const Experiment e = small();
  const FitProblem problem(e);
  std::atomic<bool> stop{false};
  MonteCarloOptions options;
  options.trials = 50;
  options.study.jobs = 2;
  options.study.interrupt = &stop;
  int reported = 0;
  options.study.progress = [&](std::uint64_t done) {
    EXPECT_EQ(done, static_cast<std::uint64_t>(++reported));
    if (done == 3) stop = true;
  };
  const MonteCarlo found = monte_carlo(problem, options);
  EXPECT_TRUE(found.interrupted);
  EXPECT_GE(found.trials, 3);
  EXPECT_LT(found.trials, 50);
  EXPECT_EQ(found.trials, reported);
}

TEST(MonteCarlo, DoesNotAcceptMeasuredRuns) {
  Experiment e = small();
  e.runs[1].data = {"swing.csv"};
  e.runs[1].line = 31;
  e.records.resize(2);
  e.records[1].sensors = {{{0.0, 0.1, 0.2}, {0.0, 0.0, 0.0}}};
  const FitProblem problem(e);
  try {
    monte_carlo(problem, {});
    FAIL() << "taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(":31: run \"low, 200 kg\": expected simulated runs only"),
              std::string::npos)
        << error.what();
  }
}

// Of 400 trials the standard errors are 1/20, 1/sqrt(800) and sqrt(0.95 0.05)/20.
TEST(MonteCarlo, ComparesStatisticsWithTheBound) {
  TrialStatistics s;
  s.bound = 2.0;
  s.bias = -0.3;
  s.rmse = 2.2;
  s.coverage = 0.93;
  const BoundStatistics found = against_bound(s, 400);
  EXPECT_DOUBLE_EQ(found.bias.value, -0.15);
  EXPECT_DOUBLE_EQ(found.bias.standard_error, 0.05);
  EXPECT_EQ(found.bias.expected, 0.0);
  EXPECT_DOUBLE_EQ(found.rmse.value, 1.1);
  EXPECT_DOUBLE_EQ(found.rmse.standard_error, 1 / std::sqrt(800.0));
  EXPECT_EQ(found.rmse.expected, 1.0);
  EXPECT_DOUBLE_EQ(found.coverage.value, 0.93);
  EXPECT_DOUBLE_EQ(found.coverage.standard_error, std::sqrt(0.0475) / 20);
  EXPECT_EQ(found.coverage.expected, 0.95);
  EXPECT_TRUE(found.as_expected());
  // 4.2 standard errors of the bias, of the root mean square error, of the coverage.
  s.bias = 0.42;
  EXPECT_FALSE(against_bound(s, 400).as_expected());
  EXPECT_TRUE(against_bound(s, 100).as_expected());
  s.bias = 0.0;
  s.rmse = 2.0 * (1 - 4.2 / std::sqrt(800.0));
  EXPECT_FALSE(against_bound(s, 400).as_expected());
  s.rmse = 2.0;
  s.coverage = 0.95 - 4.2 * std::sqrt(0.0475) / 20;
  EXPECT_FALSE(against_bound(s, 400).as_expected());
}

// Of stiffness and inertia of a wheel only the ratio is identifiable: it reaches its bound.
TEST(MonteCarlo, CombinationsReachTheirBounds) {
  Experiment e = test::Wheel(2).experiment;
  e.unknowns.push_back(test::unknown("body.wheel.inertia"));
  const FitProblem problem(e);
  MonteCarloOptions options;
  options.trials = 200;
  options.seed = 3;
  options.start_error = 0.2;
  const MonteCarlo found = monte_carlo(problem, options);
  EXPECT_GE(found.converged, 197) << "one of 1000 is a misfit by chance";
  for (const TrialStatistics& s : found.parameters) EXPECT_FALSE(s.is_identifiable());
  ASSERT_EQ(found.combinations.size(), 1U);
  const TrialStatistics& ratio = found.combinations[0];
  EXPECT_TRUE(ratio.is_identifiable());
  EXPECT_TRUE(against_bound(ratio, found.converged).as_expected())
      << ratio.name << ": rms " << ratio.rmse / ratio.bound << ", coverage " << ratio.coverage;
}

TEST(MonteCarlo, WithoutABoundNothingIsIdentifiable) {
  TrialStatistics s;
  EXPECT_FALSE(s.is_identifiable());
  s.bound = INFINITY;
  EXPECT_FALSE(s.is_identifiable());
  s.bound = 1e-300;
  EXPECT_TRUE(s.is_identifiable());
}

}  // namespace
}  // namespace poise::monte_carlo_test
