// What errors of known numbers do to estimates: against fits with these numbers changed.

#include "identification/assessment/known_numbers.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::known_numbers_test {
namespace {

// k = w^2 I: the stiffness is as uncertain as the inertia that is taken as known.
TEST(KnownNumbers, StiffnessIsAsUncertainAsTheInertia) {
  test::Wheel wheel(2);
  wheel.experiment.known = {{.path = "body.wheel.inertia", .per = "", .deviation = 0.01, .relative = true}};
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  Fit found = fit(problem, records);
  const double before = found.estimates[0].standard_error;
  const std::vector<KnownEffect> effects = known_effects(problem, found, records);
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_EQ(effects[0].name, "body.wheel.inertia");
  EXPECT_NEAR(effects[0].change[0], 0.01 * found.parameters[0], 1e-6 * found.parameters[0]);
  const double half = found.estimates[0].high - found.estimates[0].value;
  add_known_effects(effects, found);
  EXPECT_NEAR(found.estimates[0].standard_error, std::hypot(before, effects[0].change[0]), 1e-12);
  EXPECT_NEAR((found.estimates[0].high - found.estimates[0].value) / half, found.estimates[0].standard_error / before,
              1e-9);
}

// The same against a fit in which the known number has another value, for the lift's payload: it acts in the loaded
// runs only.
TEST(KnownNumbers, PayloadOfTheLift) {
  Experiment lift = test::experiment("lift_experiment_four_runs");
  lift.known = {{.path = "body.payload.mass", .per = "", .deviation = 0.002, .relative = true}};
  const FitProblem problem(lift);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const std::vector<KnownEffect> effects = known_effects(problem, found, records);
  Experiment heavier = lift;
  for (poise::Run& run : heavier.runs) {
    for (ParameterChange& change : run.changes) {
      if (change.path == "body.payload.mass") change.value *= 1.002;
    }
  }
  set_value(heavier.scene, "body.payload.mass", 1.002 * get_value(heavier.scene, "body.payload.mass"));
  const FitProblem other(heavier);
  const Fit moved = fit(other, records);
  ASSERT_EQ(effects.size(), 1U);
  for (std::size_t p = 0; p < found.parameters.size(); ++p) {
    const double expected = moved.parameters[p] - found.parameters[p];
    EXPECT_NEAR(effects[0].change[p], expected, 0.02 * std::abs(expected) + 0.05 * found.estimates[p].standard_error)
        << found.estimates[p].name;
  }
}

// A clock that is fast by a part of its time makes k = w^2 I smaller by twice that part.
TEST(KnownNumbers, ClockActsOnTheStiffnessTwice) {
  test::Wheel wheel(2);
  wheel.experiment.known = {{.path = "clock", .of_clock = true, .per = "", .deviation = 0.01}};
  const FitProblem problem(wheel.experiment);
  const std::vector<Record> records = problem.records();
  const Fit found = fit(problem, records);
  const std::vector<KnownEffect> effects = known_effects(problem, found, records);
  ASSERT_EQ(effects.size(), 1U);
  EXPECT_EQ(effects[0].name, "clock");
  EXPECT_NEAR(effects[0].change[0], -0.02 * found.parameters[0], 1e-3 * found.parameters[0]);
}

TEST(KnownNumbers, ErrorsPerRunAreIndependent) {
  test::Wheel wheel(4);
  wheel.experiment.known = {{.path = "body.wheel.inertia", .per = "", .deviation = 0.01, .relative = true}};
  Experiment apart = wheel.experiment;
  apart.known[0].per = "run";
  for (std::size_t r = 0; r < 4; ++r) apart.runs[r].name = std::to_string(r);
  const FitProblem problem(apart);
  const std::vector<Record> records = problem.records();
  Fit found = fit(problem, records);
  const std::vector<KnownEffect> effects = known_effects(problem, found, records);
  ASSERT_EQ(effects.size(), 4U);
  double squares = 0.0;
  for (const KnownEffect& effect : effects) squares += effect.change[0] * effect.change[0];
  EXPECT_NEAR(std::sqrt(squares), 0.01 * found.parameters[0] / 2, 1e-3 * 0.01 * found.parameters[0])
      << "four runs of equal weight";
}

}  // namespace
}  // namespace poise::known_numbers_test
