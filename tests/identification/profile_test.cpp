// Profile likelihood: intervals of linear problems, of bounded parameters, and their coverage.

#include "identification/assessment/profile.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::identification_profile_test {
namespace {

// A small noise makes the wheel linear: the profile is a parabola, and its interval that of the fit.
TEST(Profile, OfALinearProblemIsTheInterval) {
  const test::Wheel wheel(2);
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const LikelihoodProfile of = profile(problem, records, found, 0);
  const Estimate& k = found.estimates[0];
  ASSERT_TRUE(of.low && of.high);
  EXPECT_NEAR(*of.low, k.low, 0.01 * k.standard_error);
  EXPECT_NEAR(*of.high, k.high, 0.01 * k.standard_error);
  EXPECT_FALSE(of.one_sided);
  for (std::size_t i = 0; i < of.value.size(); ++i) {
    EXPECT_NEAR(of.growth[i], std::abs(of.value[i] - k.value) / k.standard_error, 0.01);
  }
}

// Several at a time are the same to the last bit on any number of threads.
TEST(Profile, DependsOnNoThreads) {
  test::Wheel wheel(2);
  wheel.experiment.unknowns.push_back(test::unknown("torsion_damper.air.coefficient"));
  wheel.experiment.unknowns.back().start = 1e-4;
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const LikelihoodProfile alone = profile(problem, records, found, 1);
  for (const int jobs : {1, 2}) {
    const std::vector<LikelihoodProfile> both = profiles(problem, records, found, {0, 1}, {.jobs = jobs});
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0].parameter, 0);
    EXPECT_EQ(both[1].low, alone.low);
    EXPECT_EQ(both[1].high, alone.high);
    EXPECT_EQ(both[1].value, alone.value);
    EXPECT_EQ(both[1].growth, alone.growth);
  }
  std::atomic<bool> stop = true;
  EXPECT_TRUE(profiles(problem, records, found, {0, 1}, {.interrupt = &stop}).empty());
}

// Damping that is not there is at its bound, 0: the interval begins there and ends at a one-sided limit.
TEST(Profile, AtABoundIsOneSided) {
  test::Wheel wheel(2);
  Unknown damping = test::unknown("torsion_damper.air.coefficient");
  damping.min = 0.0;
  damping.start = 1e-4;
  wheel.experiment.unknowns.push_back(damping);
  const FitProblem problem(wheel.experiment);
  int at_bound = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    std::vector<Record> records;
    for (std::size_t r = 0; r < problem.runs(); ++r) {
      records.push_back(problem.ideal_record(r));
      problem.add_noise(records.back(), solvers::RandomStream(10 * seed + r));
    }
    const Fit found = fit(problem, records);
    if (found.parameters[1] > 0) continue;
    ++at_bound;
    const LikelihoodProfile of = profile(problem, records, found, 1);
    EXPECT_TRUE(of.one_sided);
    EXPECT_EQ(of.low, 0.0);
    ASSERT_TRUE(of.high);
    EXPECT_GT(*of.high, 0.0);
    EXPECT_LT(*of.high, 1.7 * found.identifiability.standard_error[1]);
  }
  EXPECT_GE(at_bound, 1);
}

// A curved problem: the period of one short swing known to a tenth. Where the profile is held, no other fit is better.
TEST(Profile, EndsWhereTheCostHasGrownByTheLimit) {
  test::Wheel wheel(1);
  wheel.experiment.sensors[0].noise = 0.03;
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const LikelihoodProfile of = profile(problem, records, found, 0);
  ASSERT_TRUE(of.low && of.high);
  const Estimate& k = found.estimates[0];
  const double limit = (k.high - k.value) / k.standard_error;
  for (const double end : {*of.low, *of.high}) {
    FitOptions options;
    options.from = &found;
    options.held = {{0, end}};
    const Fit held = fit(problem, records, options);
    EXPECT_DOUBLE_EQ(held.parameters[0], end);
    EXPECT_NEAR(std::sqrt(2 * (held.cost - found.cost)) * found.identifiability.standard_error[0] / k.standard_error,
                limit, 0.01);
  }
  EXPECT_GT(std::abs((*of.high - k.value) - (k.value - *of.low)), 1e-3 * k.standard_error) << "not symmetric";
}

}  // namespace
}  // namespace poise::identification_profile_test
