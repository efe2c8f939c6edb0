#include "solvers/least_squares.hpp"

#include <atomic>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/plane_problem.hpp"

namespace poise::solvers::least_squares_test {
namespace {

using test::PlaneProblem;

constexpr double infinity = PlaneProblem::infinity;
constexpr double accuracy = 1e-11;

TEST(LeastSquares, FindsMaximaAsWellAsMinima) {
  const PlaneProblem problem(true);
  const SearchResult top = solve_with_least_squares(problem, {0.1, 0.95});
  EXPECT_TRUE(top.claims_success) << top.status;
  EXPECT_NEAR(top.x[0], 0.0, accuracy);
  EXPECT_NEAR(top.x[1], 1.0, accuracy);
  EXPECT_NEAR(top.multipliers[0], -4.0, accuracy);  // 4 y + lambda y = 0
  const SearchResult side = solve_with_least_squares(problem, {-0.9, 0.2});
  EXPECT_NEAR(side.x[0], -1.0, accuracy);
  EXPECT_NEAR(side.multipliers[0], -1.0, accuracy);
}

TEST(LeastSquares, BoundsHoldWithMultipliersOfTheRightSign) {
  for (const double side : {1.0, -1.0}) {
    for (const double other : {infinity, 2.0}) {
      const PlaneProblem problem(true, side > 0 ? 0.5 : -other, side > 0 ? other : -0.5);
      const SearchResult result = solve_with_least_squares(problem, {0.8, side * 0.55});
      EXPECT_TRUE(result.claims_success) << result.status;
      EXPECT_NEAR(result.x[1], side * 0.5, accuracy);
      EXPECT_NEAR(result.multipliers[0], -1.0, accuracy);
      EXPECT_NEAR(result.multipliers[1], side * -1.5, accuracy);
    }
  }
}

TEST(LeastSquares, ABoundWithAMultiplierOfWrongSignIsReleased) {
  PlaneProblem problem(false, -0.5, 0.9);
  problem.p = 0.3;
  for (const double bound : {-0.5, 0.9}) {
    const SearchResult result = solve_with_least_squares(problem, {0.0, bound});
    EXPECT_TRUE(result.claims_success) << result.status;
    EXPECT_NEAR(result.x[0], 0.3, accuracy);
    EXPECT_NEAR(result.x[1], 0.0, accuracy);
    EXPECT_NEAR(result.multipliers[0], 0.0, accuracy);
  }
}

TEST(LeastSquares, SolvesAFieldWithoutPotential) {
  PlaneProblem problem(false);
  problem.a = 2;
  problem.b = 1;
  problem.t = 1;
  problem.p = 3;
  const SearchResult result = solve_with_least_squares(problem, {0.0, 0.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.0, accuracy);   // 2 x - y = 3
  EXPECT_NEAR(result.x[1], -1.0, accuracy);  // x + y = 0
}

TEST(LeastSquares, AFieldWithoutPotentialLeansOnABound) {
  PlaneProblem problem(false, -0.5, infinity);
  problem.a = 2;
  problem.b = 1;
  problem.t = 1;
  problem.p = 3;
  const SearchResult result = solve_with_least_squares(problem, {0.0, 0.0});
  EXPECT_TRUE(result.claims_success) << result.status;
  EXPECT_NEAR(result.x[0], 1.25, accuracy);  // 2 x + 0.5 = 3
  EXPECT_NEAR(result.x[1], -0.5, accuracy);
  EXPECT_NEAR(result.multipliers[0], -0.75, accuracy);  // x + y + mu = 0
}

TEST(LeastSquares, RowsLeftOutDoNotHold) {
  PlaneProblem problem(true, 0.5, infinity);
  problem.p = 0.3;
  const SearchResult result = solve_with_least_squares(problem, {0.6, 0.8}, {}, {1});
  EXPECT_NEAR(result.x[0], 0.3, accuracy);
  EXPECT_NEAR(result.x[1], 0.5, accuracy);
  EXPECT_NEAR(result.multipliers[1], -2.0, accuracy);
  EXPECT_EQ(result.multipliers[0], 0.0);
}

// x^2 + y^2 = -1 has no solution, but the sum of squares has a smallest value.
TEST(LeastSquares, ALocalMinimumThatIsNoSolutionIsNotClaimed) {
  PlaneProblem problem(true);
  problem.r2 = -1;
  problem.p = 0.2;
  const SearchResult result = solve_with_least_squares(problem, {0.4, 0.3});
  EXPECT_FALSE(result.claims_success);
  EXPECT_NE(result.status.find("not zero"), std::string::npos) << result.status;
  EXPECT_TRUE(std::isfinite(result.x[0]) && std::isfinite(result.x[1]));
}

TEST(LeastSquares, IterationLimitIsReported) {
  const PlaneProblem problem(true);
  const SearchResult result = solve_with_least_squares(problem, {0.7, 0.6}, {.iterations = 1});
  EXPECT_FALSE(result.claims_success);
  EXPECT_EQ(result.status, "Ceres: iteration limit");
  EXPECT_EQ(result.iterations, 1);
}

TEST(LeastSquares, AnInterruptStopsTheSearchAndKeepsThePoint) {
  const PlaneProblem problem(true);
  const std::atomic<bool> stop{true};
  const SearchResult result = solve_with_least_squares(problem, {0.6, 0.8}, {.interrupt = &stop});
  EXPECT_TRUE(result.interrupted);
  EXPECT_FALSE(result.claims_success);
  EXPECT_EQ(result.status, "Ceres: interrupted");
  EXPECT_EQ(result.x, (std::vector<double>{0.6, 0.8}));
}

TEST(LeastSquares, EvaluatesNoPointTwice) {
  const PlaneProblem problem(true);
  const SearchResult result = solve_with_least_squares(problem, {0.7, 0.6});
  EXPECT_GT(result.evaluations, 2);
  EXPECT_EQ(problem.calls(), result.evaluations);
}

// min sum x_i^4/4 - t_i x_i, with every two neighbours kept at one place.
class Pairs final : public Problem {
 public:
  explicit Pairs(int n) : n_(n), jacobian_{n / 2, n, {}, {}}, tangent_{n, n, {}, {}} {
    for (int i = 0; i < n; ++i) {
      jacobian_.row.push_back(i / 2);
      jacobian_.column.push_back(i);
      tangent_.row.push_back(i);
      tangent_.column.push_back(i);
    }
  }

  static double pull(int i) { return 1.0 + 0.01 * i; }

  int variables() const override { return n_; }
  int equalities() const override { return n_ / 2; }
  const std::vector<double>& lower() const override { return none_; }
  const std::vector<double>& upper() const override { return none_; }
  bool has_objective() const override { return true; }
  const Pattern& jacobian_pattern() const override { return jacobian_; }
  const Pattern& tangent_pattern() const override { return tangent_; }
  double objective(Evaluation& at) const override {
    double sum = 0.0;
    for (int i = 0; i < n_; ++i) sum += std::pow(at.x[i], 4) / 4 - pull(i) * at.x[i];
    return sum;
  }
  void evaluate(Evaluation& at) const override {
    for (int i = 0; i < n_; ++i) {
      const double x = at.x[i];
      at.gradient[i] = x * x * x - pull(i);
      at.jacobian[i] = i % 2 == 0 ? 1.0 : -1.0;
    }
    for (int k = 0; k < n_ / 2; ++k) at.constraint[k] = at.x[2 * k] - at.x[2 * k + 1];
  }
  void tangent(Evaluation& at, std::span<const double>, std::span<double> values) const override {
    for (int i = 0; i < n_; ++i) values[i] = 3 * at.x[i] * at.x[i];
  }

 private:
  int n_;
  Pattern jacobian_, tangent_;
  std::vector<double> none_;
};

TEST(LeastSquares, SmallAndLargeProblemsAreSolvedAlike) {
  for (const int n : {6, 400}) {
    const Pairs problem(n);
    const SearchResult result = solve_with_least_squares(problem, std::vector<double>(n, 0.8));
    ASSERT_TRUE(result.claims_success) << n << ": " << result.status;
    for (int k = 0; k < n / 2; ++k) {
      const double mean = (Pairs::pull(2 * k) + Pairs::pull(2 * k + 1)) / 2;  // 2 x^3 = both pulls
      EXPECT_NEAR(result.x[2 * k], std::cbrt(mean), accuracy);
      EXPECT_NEAR(result.x[2 * k + 1], std::cbrt(mean), accuracy);
      EXPECT_NEAR(result.multipliers[k], Pairs::pull(2 * k) - mean, 10 * accuracy);  // x^3 - pull + lambda = 0
    }
  }
}

}  // namespace
}  // namespace poise::solvers::least_squares_test
