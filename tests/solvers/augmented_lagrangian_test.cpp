#include "solvers/augmented_lagrangian.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/circles_problem.hpp"
#include "tests/support/plane_problem.hpp"

namespace poise::solvers::augmented_lagrangian_test {
namespace {

using test::CirclesProblem;
using test::PlaneProblem;

constexpr double infinity = PlaneProblem::infinity;
constexpr double accuracy = 1e-11;

AugmentedLagrangianOptions with(Tangent tangent, int iterations = 1000) {
  AugmentedLagrangianOptions options;
  options.tangent = tangent;
  options.iterations = iterations;
  return options;
}

// What both tangents must do alike.
class AugmentedLagrangian : public testing::TestWithParam<Tangent> {
 protected:
  SearchResult solve(const Problem& problem, const std::vector<double>& start,
                     const std::vector<int>& rows = {}) const {
    return solve_with_augmented_lagrangian(problem, start, with(GetParam()), rows);
  }
};
INSTANTIATE_TEST_SUITE_P(With, AugmentedLagrangian, testing::Values(Tangent::newton, Tangent::modified),
                         [](const auto& with) { return with.param == Tangent::newton ? "Newton" : "Modified"; });

TEST_P(AugmentedLagrangian, FindsTheEquilibriumOnACircle) {
  const SearchResult result = solve(PlaneProblem(true), {0.9, 0.3});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);
  EXPECT_NEAR(result.x[1], 0.0, accuracy);
  EXPECT_NEAR(result.multipliers[0], -1.0, accuracy);  // x + lambda x = 0
}

TEST_P(AugmentedLagrangian, ConvergesForEveryScaleAndPenalty) {
  for (const double k : {1e-3, 1.0, 1e3}) {
    for (const double p : {0.0, 10.0, 1e3}) {
      AugmentedLagrangianOptions options = with(GetParam());
      options.multiplier_scale = k;
      options.penalty = p;
      const SearchResult result = solve_with_augmented_lagrangian(PlaneProblem(true), {0.9, 0.3}, options);
      EXPECT_TRUE(result.claims_success) << k << ", " << p << ": " << result.status;
      EXPECT_NEAR(std::abs(result.x[0]), 1.0, accuracy);
      EXPECT_NEAR(result.multipliers[0], -1.0, 1e3 * accuracy);
    }
  }
}

TEST_P(AugmentedLagrangian, SolvesAFieldWithoutPotential) {
  PlaneProblem problem(false);
  problem.a = 2;
  problem.b = 1;
  problem.t = 1;
  problem.p = 3;
  const SearchResult result = solve(problem, {0.0, 0.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);   // 2 x - y = 3
  EXPECT_NEAR(result.x[1], -1.0, accuracy);  // x + y = 0
}

TEST_P(AugmentedLagrangian, BoundsHoldWithMultipliersOfTheRightSign) {
  for (const double side : {1.0, -1.0}) {
    const PlaneProblem problem(true, side > 0 ? 0.5 : -infinity, side > 0 ? infinity : -0.5);
    const SearchResult result = solve(problem, {0.8, side * 0.55});
    EXPECT_TRUE(result.claims_success) << result.status;
    EXPECT_NEAR(result.x[0], std::sqrt(0.75), accuracy);
    EXPECT_NEAR(result.x[1], side * 0.5, accuracy);
    EXPECT_NEAR(result.multipliers[0], -1.0, accuracy);
    EXPECT_NEAR(result.multipliers[1], side * -1.5, accuracy);
  }
}

TEST_P(AugmentedLagrangian, ABoundWithAMultiplierOfWrongSignIsReleased) {
  PlaneProblem problem(false, -0.5, 0.9);
  problem.p = 0.3;
  for (const double bound : {-0.5, 0.9, 2.0}) {
    const SearchResult result = solve(problem, {0.0, bound});
    EXPECT_TRUE(result.claims_success) << result.status;
    EXPECT_NEAR(result.x[0], 0.3, accuracy);
    EXPECT_NEAR(result.x[1], 0.0, accuracy);
    EXPECT_EQ(result.multipliers[0], 0.0);
  }
}

TEST_P(AugmentedLagrangian, RowsLeftOutAreNotSolvedForButMustHold) {
  PlaneProblem problem(true, 0.5, infinity);
  problem.p = 0.3;
  const SearchResult result = solve(problem, {0.6, 0.8}, {1});
  EXPECT_NEAR(result.x[0], 0.3, accuracy);
  EXPECT_NEAR(result.x[1], 0.5, accuracy);
  EXPECT_EQ(result.multipliers[0], 0.0);
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("left out"), std::string::npos) << result.status;
}

TEST_P(AugmentedLagrangian, SmallLargeAndRepeatedConstraintsAreSolvedAlike) {
  for (const int circles : {3, 200}) {
    for (const bool twice : {false, true}) {
      const SearchResult result = solve(CirclesProblem(circles, twice), std::vector<double>(2 * circles, 0.7));
      ASSERT_TRUE(result.claims_success) << circles << ": " << result.status;
      for (int k = 0; k < circles; ++k) {
        EXPECT_NEAR(result.x[2 * k], 1.0, accuracy);
        EXPECT_NEAR(result.x[2 * k + 1], 0.0, accuracy);
        const double held = result.multipliers[k] + (twice ? result.multipliers[circles + k] : 0.0);
        EXPECT_NEAR(held, CirclesProblem::pull(k) - 1.0, accuracy);
      }
    }
  }
}

TEST_P(AugmentedLagrangian, WhatCannotBeMetIsNotClaimed) {
  PlaneProblem problem(true);
  problem.r2 = -1;
  const SearchResult result = solve(problem, {0.4, 0.3});
  EXPECT_FALSE(result.claims_success);
  EXPECT_TRUE(std::isfinite(result.x[0]) && std::isfinite(result.x[1]));
}

// Only the origin is on a circle without radius, and there no multiplier balances a pull.
TEST_P(AugmentedLagrangian, ALockedPointIsNotClaimed) {
  PlaneProblem problem(true);
  problem.r2 = 0;
  problem.p = 1;
  const SearchResult result = solve(problem, {0.1, 0.1});
  EXPECT_FALSE(result.claims_success);
  EXPECT_LT(std::hypot(result.x[0], result.x[1]), 0.1);
}

TEST_P(AugmentedLagrangian, IterationLimitIsReported) {
  const SearchResult result = solve_with_augmented_lagrangian(PlaneProblem(true), {0.7, 0.6}, with(GetParam(), 2));
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("iteration limit"), std::string::npos) << result.status;
  EXPECT_EQ(result.iterations, 2);
}

TEST_P(AugmentedLagrangian, AnInterruptStopsTheSearchAndKeepsThePoint) {
  const std::atomic<bool> stop{true};
  AugmentedLagrangianOptions options = with(GetParam());
  options.interrupt = &stop;
  const SearchResult result = solve_with_augmented_lagrangian(PlaneProblem(true), {0.6, 0.8}, options);
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.claims_success);
  EXPECT_EQ(result.x, (std::vector<double>{0.6, 0.8}));
}

TEST_P(AugmentedLagrangian, CountsEveryEvaluation) {
  const PlaneProblem problem(true);
  const SearchResult result = solve(problem, {0.7, 0.6});
  EXPECT_GT(result.evaluations, 2);
  EXPECT_EQ(problem.calls(), result.evaluations);
}

TEST(AugmentedLagrangianTangents, OnlyTheExactOneFindsAMaximum) {
  const PlaneProblem problem(true);
  const SearchResult top = solve_with_augmented_lagrangian(problem, {0.1, 0.95}, with(Tangent::newton));
  EXPECT_TRUE(top.claims_success) << top.status;
  EXPECT_NEAR(top.x[1], 1.0, accuracy);
  EXPECT_NEAR(top.multipliers[0], -4.0, accuracy);
  // Without the curvature of the circle the tangent has a = 1 along it where the truth is a - b = -3: steps lead away.
  const SearchResult modified = solve_with_augmented_lagrangian(problem, {0.1, 0.95}, with(Tangent::modified));
  EXPECT_GT(std::abs(modified.x[0]), 0.9);
}

// |y| after that many steps towards (1, 0).
double distance_after(int steps, Tangent tangent) {
  return std::abs(solve_with_augmented_lagrangian(PlaneProblem(true), {0.95, 0.2}, with(tangent, steps)).x[1]);
}

TEST(AugmentedLagrangianTangents, TheExactOneConvergesQuadraticallyTheModifiedOneLinearly) {
  const double first = distance_after(1, Tangent::newton);
  const double second = distance_after(2, Tangent::newton);
  EXPECT_GT(first, 1e-4);
  EXPECT_LT(second, 5 * first * first);
  EXPECT_LT(distance_after(3, Tangent::newton), 5 * second * second + 1e-15);
  // Along the circle the modified tangent is b = 4, the truth b - a = 3: each step leaves 1 - 3/4.
  for (int steps = 4; steps < 12; ++steps) {
    const double ratio = distance_after(steps + 1, Tangent::modified) / distance_after(steps, Tangent::modified);
    EXPECT_NEAR(ratio, 0.25, 0.01) << steps;
  }
}

// F = log x knows no x below zero; the first whole step from 3 would go there.
class Logarithm final : public Problem {
 public:
  int variables() const override { return 1; }
  int equalities() const override { return 0; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return true; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation& at) const override { return at.x[0] * (std::log(at.x[0]) - 1); }
  void evaluate(Evaluation& at) const override { at.gradient[0] = std::log(at.x[0]); }
  void tangent(Evaluation& at, std::span<const double>, std::span<double> values) const override {
    values[0] = 1 / at.x[0];
  }

 private:
  Pattern jacobian_{0, 1, {}, {}}, tangent_{1, 1, {0}, {0}};
  std::vector<double> none_;
};

TEST_P(AugmentedLagrangian, WhatIsNoNumberIsSteppedRound) {
  const SearchResult result = solve(Logarithm(), {3.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);
}

}  // namespace
}  // namespace poise::solvers::augmented_lagrangian_test
