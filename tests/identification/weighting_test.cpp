// Losses: their slopes, weights and the triangles that carry their costs.

#include "identification/experiment/weighting.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::weighting_test {
namespace {

constexpr Loss all[] = {Loss::squares, Loss::huber, Loss::cauchy, Loss::student};

TEST(Weighting, WeightIsTheSlopeOfTheCostAndPsiSlopeThatOfPsi) {
  for (const Loss loss : all) {
    const Weighting weighting{{}, loss};
    for (const double e : {0.1, 0.9, 1.7, 5.0, 100.0}) {
      const double h = 1e-5 * e;
      const auto cost = [&](double x) { return weighting.cost(x * x); };
      const auto psi = [&](double x) { return x * weighting.weight(x * x); };
      EXPECT_NEAR((cost(e + h) - cost(e - h)) / (2 * h), 2 * psi(e), 1e-7 * (1 + e)) << to_string(loss);
      EXPECT_NEAR((psi(e + h) - psi(e - h)) / (2 * h), weighting.psi_slope(e * e), 1e-6) << to_string(loss);
      EXPECT_GE(weighting.cost(e * e), weighting.weight(e * e) * e * e * (1 - 1e-12)) << "concave";
    }
    EXPECT_EQ(loss_of(to_string(loss)), loss);
  }
  EXPECT_FALSE(loss_of("tukey"));
}

// |last column|^2 = sum rho, and the gradient of half of it is R^T R_e.
TEST(Weighting, TrianglesCarryCostAndGradient) {
  for (const Loss loss : all) {
    SCOPED_TRACE(to_string(loss));
    test::Wheel wheel(1);
    wheel.experiment.loss = loss;
    const FitProblem problem(wheel.experiment);
    const Record record = problem.records()[0];
    const std::vector<double> start = problem.run(0).released();
    const auto triangle = [&](double stiffness) {
      return problem.triangle(0, {stiffness}, start, &record, INFINITY, 1e-11, problem.weighting());
    };
    const double k = test::Wheel::stiffness * 1.001;
    const Eigen::MatrixXd R = triangle(k);
    const LinearRun run = problem.linearized(0, {k}, start, &record, INFINITY, 1e-11, problem.weighting());
    double sum = 0.0;
    for (const double e : run.residuals(0)) sum += problem.weighting().cost(e * e);
    EXPECT_NEAR(R.col(3).squaredNorm(), sum, 1e-9 * sum);
    const auto half = [&](double by) { return std::vector<double>{triangle(k + by).col(3).squaredNorm() / 2}; };
    const double gradient = R.col(2).dot(R.col(3));
    EXPECT_NEAR(test::derivative(half, 1e-5)[0], gradient, 2e-4 * std::abs(gradient));
  }
}

}  // namespace
}  // namespace poise::weighting_test
