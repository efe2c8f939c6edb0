#include "solvers/nlopt.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

namespace poise::solvers::nlopt_test {
namespace {

double rosenbrock(const double* x) { return 100 * std::pow(x[1] - x[0] * x[0], 2) + std::pow(1 - x[0], 2); }

TEST(Nlopt, FindsTheMinimumOfABentValley) {
  const NloptResult result = minimise_with_nlopt(rosenbrock, {-5, -5}, {5, 5}, {-1.2, 1});
  EXPECT_NEAR(result.x[0], 1.0, 1e-4);
  EXPECT_NEAR(result.x[1], 1.0, 1e-4);
  EXPECT_EQ(result.value, rosenbrock(result.x.data()));
}

TEST(Nlopt, StaysWithinBounds) {
  bool outside = false;
  const auto f = [&](const double* x) {
    outside = outside || x[0] < -2 || x[0] > 0.5 || x[1] < -1 || x[1] > 2;
    return rosenbrock(x);
  };
  const NloptResult result = minimise_with_nlopt(f, {-2, -1}, {0.5, 2}, {7, 7});
  EXPECT_FALSE(outside);
  EXPECT_NEAR(result.x[0], 0.5, 1e-6);  // on the bound: x1 = x0^2
  EXPECT_NEAR(result.x[1], 0.25, 1e-4);
}

TEST(Nlopt, StopsWhereItIsGoodEnough) {
  NloptOptions options;
  options.good_enough = 1.0;
  const NloptResult result = minimise_with_nlopt(rosenbrock, {-5, -5}, {5, 5}, {-1.2, 1}, options);
  EXPECT_TRUE(result.good_enough);
  EXPECT_LE(result.value, 1.0);
  EXPECT_GT(result.value, 1e-6);
}

TEST(Nlopt, StopsAtTheLimitOfEvaluations) {
  NloptOptions options;
  options.evaluations = 30;
  const NloptResult result = minimise_with_nlopt(rosenbrock, {-5, -5}, {5, 5}, {-1.2, 1}, options);
  EXPECT_EQ(result.evaluations, 30);
  EXPECT_FALSE(result.good_enough);
  EXPECT_EQ(result.status, "NLopt: evaluation limit");
}

TEST(Nlopt, CanBeInterrupted) {
  const std::atomic<bool> interrupt = true;
  NloptOptions options;
  options.interrupt = &interrupt;
  const NloptResult result = minimise_with_nlopt(rosenbrock, {-5, -5}, {5, 5}, {-1.2, 1}, options);
  EXPECT_TRUE(result.interrupted);
  EXPECT_LE(result.evaluations, 2);
}

}  // namespace
}  // namespace poise::solvers::nlopt_test
