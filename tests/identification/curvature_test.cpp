// Intervals where the cost is no parabola, against closed forms.

#include "identification/fit/curvature.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::curvature_test {
namespace {

// A wheel whose centre of mass is c from its pin, without gravity: it moves as if its inertia were J + m c^2. With the
// standard error e of the parabola the interval of c^2 is  c^2 +- 2 c t e,  t = 1.96.
struct OffCentre {
  static constexpr double c = 0.1;
  Experiment experiment = test::Wheel(1).experiment;

  explicit OffCentre(double noise) {
    experiment.scene.bodies[1].mass = 1.0;
    experiment.scene.bodies[1].center = {c, 0};
    experiment.sensors[0].noise = noise;
    experiment.unknowns = {test::unknown("body.wheel.center.x")};
    experiment.unknowns[0].scale = 1.0;
  }
};

TEST(Curvature, OfANumberThatActsByItsSquare) {
  OffCentre wheel(1.4e-3);
  wheel.experiment.unknowns[0].min = 0.0;  // -c is another minimum
  const FitProblem problem(wheel.experiment);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  const Estimate& c = found.estimates[0];
  const double size = std::abs(c.value);
  const double reach = found.errors.reach[0];
  EXPECT_GT(reach, 0.3 * size);
  EXPECT_LT(reach, 0.48 * size);
  EXPECT_TRUE(c.is_curved);
  ASSERT_EQ(found.traces.size(), 1U);
  EXPECT_GE(found.check_evaluations, 2);  // one fit to either side at least
  const double nearer = std::sqrt(size * size - 2 * size * reach);
  EXPECT_NEAR(c.value > 0 ? c.low : -c.high, nearer, 0.03 * size);
  // Never shorter than by the parabola.
  EXPECT_NEAR(c.value > 0 ? c.high : -c.low, size + reach, 1e-3 * size);
  EXPECT_NEAR(c.standard_error / found.errors.error[0], (size - nearer) / reach, 0.05);
}

// So large a noise does not tell c from zero: the interval goes on to the same motion with the opposite sign.
TEST(Curvature, OfANumberThatMayHaveEitherSign) {
  const OffCentre wheel(5e-3);
  const FitProblem problem(wheel.experiment);
  const Fit found = fit(problem, problem.records());
  ASSERT_TRUE(found.usable()) << found.why;
  const Estimate& c = found.estimates[0];
  const double size = std::abs(c.value);
  const double reach = found.errors.reach[0];
  ASSERT_GT(reach, 0.6 * size);
  const double farther = std::sqrt(size * size + 2 * size * reach);
  EXPECT_NEAR(c.value > 0 ? c.low : -c.high, -farther, 0.05 * size);
  EXPECT_GT(found.traces.at(0).slow_low + found.traces.at(0).slow_high, 2.0);
}

TEST(Curvature, NoneWhereTheCostIsAParabola) {
  OffCentre wheel(1e-5);
  wheel.experiment.unknowns[0].min = 0.0;  // -c is another minimum
  const FitProblem problem(wheel.experiment);
  const Fit found = fit(problem, problem.records());
  EXPECT_TRUE(found.usable()) << found.why;
  EXPECT_TRUE(found.traces.empty());
  EXPECT_EQ(found.check_evaluations, 0);
  EXPECT_FALSE(found.estimates[0].is_curved);
  EXPECT_NEAR((found.estimates[0].high - found.estimates[0].value) / found.errors.reach[0], 1.0, 1e-9);
}

}  // namespace
}  // namespace poise::curvature_test
