#include "solvers/nlopt_program.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/plane_problem.hpp"

namespace poise::solvers::nlopt_program_test {
namespace {

using test::PlaneProblem;

constexpr double infinity = PlaneProblem::infinity;

struct Case {
  NloptAlgorithm algorithm;
  const char* name;
  double accuracy;  // values of f alone tell steps of 1e-8
};

class NloptProgram : public testing::TestWithParam<Case> {
 protected:
  SearchResult solve(const Problem& problem, const std::vector<double>& start, const SearchOptions& options = {},
                     const std::vector<int>& rows = {}) const {
    SearchResult result = solve_with_nlopt(GetParam().algorithm, problem, start, options, rows);
    EXPECT_TRUE(std::all_of(result.x.begin(), result.x.end(), [](double x) { return std::isfinite(x); }));
    return result;
  }
  double accuracy() const { return GetParam().accuracy; }
  bool uses_gradients() const { return GetParam().algorithm != NloptAlgorithm::cobyla; }
};
INSTANTIATE_TEST_SUITE_P(Algorithms, NloptProgram,
                         testing::Values(Case{NloptAlgorithm::slsqp, "slsqp", 1e-11},
                                         Case{NloptAlgorithm::auglag_lbfgs, "auglag_lbfgs", 1e-11},
                                         Case{NloptAlgorithm::cobyla, "cobyla", 1e-6}),
                         [](const auto& instance) { return instance.param.name; });

TEST_P(NloptProgram, FindsTheLowestPointOfACircleAndItsMultiplier) {
  const PlaneProblem problem(true);
  const SearchResult result = solve(problem, {0.6, 0.8});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(std::abs(result.x[0]), 1.0, accuracy());
  EXPECT_NEAR(result.x[1], 0.0, accuracy());
  ASSERT_EQ(result.multipliers.size(), 1U);
  EXPECT_NEAR(result.multipliers[0], -1.0, 10 * accuracy());  // x + lambda x = 0
}

TEST_P(NloptProgram, BoundsHoldWithMultipliersOfTheRightSign) {
  for (const double side : {1.0, -1.0}) {
    const PlaneProblem problem(true, side > 0 ? 0.5 : -infinity, side > 0 ? infinity : -0.5);
    const SearchResult result = solve(problem, {0.6, side * 0.8});
    // At the kink of a penalty L-BFGS finds no step and reports failure.
    EXPECT_TRUE(result.claims_success || GetParam().algorithm == NloptAlgorithm::auglag_lbfgs) << result.status;
    EXPECT_NEAR(result.x[1], side * 0.5, accuracy());
    // x + lambda x = 0, 4 y + lambda y + mu = 0
    ASSERT_EQ(result.multipliers.size(), 2U);
    EXPECT_NEAR(result.multipliers[0], -1.0, 10 * accuracy());
    EXPECT_NEAR(result.multipliers[1], side * -1.5, 10 * accuracy());
  }
}

TEST_P(NloptProgram, BoundsThatDoNotHoldBearNothing) {
  const PlaneProblem problem(true, -0.9, 0.9);
  const SearchResult result = solve(problem, {0.6, 0.8});
  EXPECT_NEAR(result.x[1], 0.0, accuracy());
  EXPECT_EQ(result.multipliers[1], 0.0);
}

TEST_P(NloptProgram, EqualBoundsAreAnEquation) {
  PlaneProblem problem(false, 0.5, 0.5);
  problem.p = 0.3;
  const SearchResult result = solve(problem, {2.0, -1.0});
  EXPECT_NEAR(result.x[0], 0.3, accuracy());
  EXPECT_NEAR(result.x[1], 0.5, accuracy());
  EXPECT_NEAR(result.multipliers[0], -2.0, 10 * accuracy());
}

TEST_P(NloptProgram, RowsLeftOutDoNotHold) {
  PlaneProblem problem(true, 0.5, infinity);
  problem.p = 0.3;
  const SearchResult result = solve(problem, {0.6, 0.8}, {}, {1});
  EXPECT_NEAR(result.x[0], 0.3, accuracy());
  EXPECT_NEAR(result.x[1], 0.5, accuracy());
  EXPECT_EQ(result.multipliers[0], 0.0);
}

// With f of 1e6 a step of 1e-6 changes f by less than its rounding: only gradients resolve it.
TEST_P(NloptProgram, RoundingOfTheObjectiveHidesNothingFromGradients) {
  PlaneProblem problem(true);
  problem.a = 1.0;
  problem.b = 3.7;
  problem.p = 0.4;
  problem.offset = 1e6;
  const SearchResult result = solve(problem, {0.6, 0.8});
  // (a + lambda) x = p, (b + lambda) y = 0 at the lowest point (1, 0)
  const double error = std::hypot(result.x[0] - 1, result.x[1]);
  if (uses_gradients()) {
    EXPECT_LT(error, 1e-11);
  } else {
    EXPECT_LT(error, 1e-3);
    EXPECT_GT(error, 1e-9);
  }
}

TEST_P(NloptProgram, EvaluatesNoPointTwice) {
  const PlaneProblem problem(true, -0.9, 0.9);
  const SearchResult result = solve(problem, {0.6, 0.8}, {.tolerance = 1e-6});
  EXPECT_GT(result.evaluations, 5);
  // The start and where each search ends are judged besides, at most two points a search.
  EXPECT_LE(problem.calls(), result.evaluations + (uses_gradients() ? 7 : 2));
}

TEST_P(NloptProgram, EvaluationLimitIsReported) {
  const PlaneProblem problem(true);
  const SearchResult result = solve(problem, {0.6, 0.8}, {.iterations = 3});
  EXPECT_FALSE(result.claims_success);
  EXPECT_LE(result.evaluations, 5);
  EXPECT_NE(result.status.find("evaluation limit"), std::string::npos) << result.status;
}

TEST_P(NloptProgram, AnInterruptStopsTheSearch) {
  const PlaneProblem problem(true);
  const std::atomic<bool> stop{true};
  const SearchResult result = solve(problem, {0.6, 0.8}, {.interrupt = &stop});
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.claims_success);
  EXPECT_LE(result.evaluations, 3);
  EXPECT_NE(result.status.find("interrupted"), std::string::npos) << result.status;
}

TEST_P(NloptProgram, AnUnboundedObjectiveEndsAtAFinitePoint) {
  PlaneProblem problem(false);
  problem.b = -1.0;
  const SearchResult result = solve(problem, {0.0, 0.1}, {.iterations = 500});
  EXPECT_EQ(result.x.size(), 2U);
}

// An empty set has no minimum, whatever NLopt reports.
TEST_P(NloptProgram, WhatCannotHoldStaysOpen) {
  PlaneProblem problem(true);
  problem.r2 = -1.0;
  const SearchResult result = solve(problem, {0.3, 0.2}, {.iterations = 2000});
  EXPECT_LT(std::hypot(result.x[0], result.x[1]), 1.0);
}

}  // namespace
}  // namespace poise::solvers::nlopt_program_test
