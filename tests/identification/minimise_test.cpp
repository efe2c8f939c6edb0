// One descent to a minimum of the cost.

#include "identification/fit/private/minimise.hpp"

#include <atomic>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/identification/wheel.hpp"

namespace poise::minimise_test {
namespace {

class Minimise : public ::testing::Test {
 protected:
  /// Descends from a stiffness.
  Minimum from(double stiffness, double window = 1.0) {
    return minimise(task_, problem_.weighting(), {{stiffness}, test::released(problem_)}, window, effort_);
  }

  test::Wheel wheel_{2};
  const FitProblem problem_{wheel_.experiment};
  const std::vector<Record> records_ = problem_.records();
  FitOptions options_;
  const FitTask task_{problem_, records_, options_, 100, 5};
  FitEffort effort_;
};

TEST_F(Minimise, ReachesTheTruthFromNearBy) {
  const Minimum found = from(1.1 * test::Wheel::stiffness);
  ASSERT_TRUE(found.is_reached());
  EXPECT_NEAR(found.point.parameters[0], test::Wheel::stiffness, 0.01);
  EXPECT_NEAR(2 * found.cost, 100, 60);
  EXPECT_GT(effort_.iterations, 0);
  EXPECT_GT(effort_.evaluations, 0);
  EXPECT_EQ(effort_.tries, 0);
}

TEST_F(Minimise, LinearizesAtTheMinimumOnce) {
  const Minimum found = from(1.1 * test::Wheel::stiffness);
  ASSERT_EQ(found.computed.size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    if (!found.computed[r]) continue;
    const LinearRun again = problem_.linearized(r, found.point.parameters, found.point.nuisances[r], &records_[r],
                                                INFINITY, problem_.accuracy(r), problem_.weighting());
    EXPECT_LE((found.computed[r]->rows - again.rows).norm(), 1e-12 * again.rows.norm());
  }
}

TEST_F(Minimise, OverAWindowIsOnlyAStart) {
  const Minimum found = from(1.1 * test::Wheel::stiffness, 0.5);
  ASSERT_TRUE(found.is_reached());
  EXPECT_TRUE(found.computed.empty());
  EXPECT_NEAR(found.point.parameters[0], test::Wheel::stiffness, 0.2);
}

TEST_F(Minimise, KeepsHeldValues) {
  options_.held = {{0, 0.0}};
  EXPECT_EQ(from(1.1 * test::Wheel::stiffness).point.parameters[0], 1.1 * test::Wheel::stiffness);
}

/// A wheel whose swings grow, of which no damping is the cause: the best damping that is possible is none.
TEST(MinimiseAtABound, EndsInFewEvaluationsFromAfarAndAtOnceFromTheMinimum) {
  test::Wheel wheel(2);
  wheel.experiment.unknowns.push_back(test::unknown("torsion_damper.air.coefficient"));
  wheel.experiment.unknowns.back().min = 0.0;
  wheel.experiment.unknowns.back().start = 0.2;
  wheel.experiment.unknowns.back().scale = 1.0;
  wheel.experiment.unknowns.front().start = 1.1 * test::Wheel::stiffness;
  const FitProblem problem(wheel.experiment);
  std::vector<Record> records = problem.records();
  for (Record& record : records) {
    for (std::size_t i = 0; i < record.sensors[0].time.size(); ++i) {
      const double time = record.sensors[0].time[i];
      record.sensors[0].value[i] = std::exp(0.3 * time) * test::Wheel::at(time);
    }
  }
  const FitOptions options;
  const FitTask task{problem, records, options, 100, 6};
  FitEffort effort;
  const Minimum found = minimise(task, problem.weighting(), {problem.starts(), test::released(problem)}, 1.0, effort);
  ASSERT_TRUE(found.is_reached());
  EXPECT_EQ(found.point.parameters[1], 0.0);
  EXPECT_LE(effort.evaluations, 15);
  FitEffort again;
  const Minimum same = minimise(task, problem.weighting(), found.point, 1.0, again);
  EXPECT_EQ(same.point.parameters[1], 0.0);
  EXPECT_NEAR(same.cost, found.cost, 1e-6 * found.cost);
  EXPECT_LE(again.evaluations, 4);
}

TEST_F(Minimise, SaysWhyThereIsNone) {
  const std::atomic<bool> interrupt = true;
  options_.interrupt = &interrupt;
  const Minimum none = from(1.1 * test::Wheel::stiffness);
  EXPECT_FALSE(none.is_reached());
  EXPECT_FALSE(none.why_not.empty());
  EXPECT_EQ(none.point.parameters[0], 1.1 * test::Wheel::stiffness);
}

}  // namespace
}  // namespace poise::minimise_test
