#include "solvers/dynamic_relaxation.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/circles_problem.hpp"
#include "tests/support/plane_problem.hpp"

namespace poise::solvers::dynamic_relaxation_test {
namespace {

using test::CirclesProblem;
using test::PlaneProblem;

constexpr double infinity = PlaneProblem::infinity;
constexpr double accuracy = 1e-11;

TEST(DynamicRelaxation, FallsOffAMaximumToRest) {
  const PlaneProblem problem(true);
  const SearchResult result = solve_with_dynamic_relaxation(problem, {0.01, 1.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);
  EXPECT_NEAR(result.x[1], 0.0, accuracy);
  EXPECT_NEAR(result.multipliers[0], -1.0, accuracy);  // x + lambda x = 0
  EXPECT_EQ(problem.calls(), result.evaluations);
}

// Without rates nothing moves where forces balance.
TEST(DynamicRelaxation, StaysOnTopOfAMaximum) {
  const SearchResult result = solve_with_dynamic_relaxation(PlaneProblem(true), {0.0, 1.0});
  EXPECT_TRUE(result.claims_success);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_NEAR(result.multipliers[0], -4.0, accuracy);
}

TEST(DynamicRelaxation, StiffnessesFarApartStayStable) {
  for (const double b : {1.0, 1e3, 1e6, 1e9}) {
    PlaneProblem problem(false);
    problem.b = b;
    problem.p = 0.5;
    const SearchResult result = solve_with_dynamic_relaxation(problem, {2.0, 1.0});
    EXPECT_TRUE(result.claims_success) << b << ": " << result.status;
    EXPECT_NEAR(result.x[0], 0.5, accuracy);
    EXPECT_NEAR(result.x[1], 0.0, accuracy);
    EXPECT_LT(result.iterations, 200) << b;
  }
}

TEST(DynamicRelaxation, SolvesAFieldWithoutPotential) {
  PlaneProblem problem(false);
  problem.a = 2;
  problem.b = 1;
  problem.t = 1;
  problem.p = 3;
  const SearchResult result = solve_with_dynamic_relaxation(problem, {0.0, 0.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);   // 2 x - y = 3
  EXPECT_NEAR(result.x[1], -1.0, accuracy);  // x + y = 0
}

TEST(DynamicRelaxation, BoundsHoldWithMultipliersOfTheRightSign) {
  for (const double side : {1.0, -1.0}) {
    const PlaneProblem problem(true, side > 0 ? 0.5 : -infinity, side > 0 ? infinity : -0.5);
    const SearchResult result = solve_with_dynamic_relaxation(problem, {0.3, side * 0.95});
    EXPECT_TRUE(result.claims_success) << result.status;
    EXPECT_NEAR(result.x[0], std::sqrt(0.75), accuracy);
    EXPECT_NEAR(result.x[1], side * 0.5, accuracy);
    EXPECT_NEAR(result.multipliers[0], -1.0, accuracy);
    EXPECT_NEAR(result.multipliers[1], side * -1.5, accuracy);
  }
}

TEST(DynamicRelaxation, ABoundWithAMultiplierOfWrongSignIsReleased) {
  PlaneProblem problem(false, -0.5, 0.9);
  problem.p = 0.3;
  for (const double bound : {-0.5, 0.9, 2.0}) {
    const SearchResult result = solve_with_dynamic_relaxation(problem, {0.0, bound});
    EXPECT_TRUE(result.claims_success) << result.status;
    EXPECT_NEAR(result.x[0], 0.3, accuracy);
    EXPECT_NEAR(result.x[1], 0.0, accuracy);
    EXPECT_EQ(result.multipliers[0], 0.0);
  }
}

TEST(DynamicRelaxation, RowsLeftOutAreNotSolvedForButMustHold) {
  PlaneProblem problem(true, 0.5, infinity);
  problem.p = 0.3;
  const SearchResult result = solve_with_dynamic_relaxation(problem, {0.6, 0.8}, {}, {1});
  EXPECT_NEAR(result.x[0], 0.3, accuracy);
  EXPECT_NEAR(result.x[1], 0.5, accuracy);
  EXPECT_EQ(result.multipliers[0], 0.0);
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("left out"), std::string::npos) << result.status;
}

TEST(DynamicRelaxation, SmallLargeAndRepeatedConstraintsAreSolvedAlike) {
  for (const int circles : {3, 200}) {
    for (const bool twice : {false, true}) {
      const SearchResult result =
          solve_with_dynamic_relaxation(CirclesProblem(circles, twice), std::vector<double>(2 * circles, 0.7));
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

TEST(DynamicRelaxation, AnUnboundedObjectiveIsReported) {
  PlaneProblem problem(false);
  problem.a = 0;
  problem.p = 1;
  const SearchResult result = solve_with_dynamic_relaxation(problem, {0.0, 0.5});
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("the motion diverges"), std::string::npos) << result.status;
  EXPECT_TRUE(std::isfinite(result.x[0]));
}

TEST(DynamicRelaxation, WhatCannotBeMetIsNotClaimed) {
  PlaneProblem problem(true);
  problem.r2 = -1;
  const SearchResult result = solve_with_dynamic_relaxation(problem, {0.4, 0.3});
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("could not be closed"), std::string::npos) << result.status;
  EXPECT_TRUE(std::isfinite(result.x[0]) && std::isfinite(result.x[1]));
}

TEST(DynamicRelaxation, IterationLimitIsReported) {
  const SearchResult result = solve_with_dynamic_relaxation(PlaneProblem(true), {0.6, 0.8}, {.iterations = 3});
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("iteration limit"), std::string::npos) << result.status;
  EXPECT_EQ(result.iterations, 3);
}

TEST(DynamicRelaxation, AnInterruptStopsTheSearchAndKeepsThePoint) {
  const std::atomic<bool> stop{true};
  const SearchResult result = solve_with_dynamic_relaxation(PlaneProblem(true), {0.6, 0.8}, {.interrupt = &stop});
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.claims_success);
  EXPECT_NEAR(result.x[0], 0.6, 1e-15);
  EXPECT_NEAR(result.x[1], 0.8, 1e-15);
}

}  // namespace
}  // namespace poise::solvers::dynamic_relaxation_test
