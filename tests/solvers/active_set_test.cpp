#include "solvers/active_set.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "tests/support/plane_problem.hpp"

namespace poise::solvers::active_set_test {
namespace {

using test::PlaneProblem;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

// A circle and 0 <= y <= 1.
class ActiveSetOnAStrip : public testing::Test {
 protected:
  Evaluation at(double y) const {
    Evaluation e = problem.make_evaluation();
    e.x = {0.0, y};
    problem.evaluate(e);
    return e;
  }

  const PlaneProblem problem{true, 0.0, 1.0};
  ActiveSet active{problem};
};

TEST_F(ActiveSetOnAStrip, HoldsEqualitiesAlwaysAndBoundsWhereTheyAreReached) {
  EXPECT_EQ(active.rows(), std::vector<int>{0});
  EXPECT_FALSE(active.activate_violated(at(0.5), 0.0));
  EXPECT_TRUE(active.activate_violated(at(1.25), 0.0));
  EXPECT_EQ(active.rows(), (std::vector<int>{0, 1}));
  EXPECT_DOUBLE_EQ(active.gap(at(1.25), 1), 0.25);
  active.reset();
  EXPECT_EQ(active.rows(), std::vector<int>{0});
  EXPECT_TRUE(active.activate_touched(at(5e-10)));
  EXPECT_DOUBLE_EQ(active.gap(at(-0.25), 1), -0.25);
}

TEST_F(ActiveSetOnAStrip, NanViolatesNothingButIsAGap) {
  EXPECT_FALSE(active.activate_violated(at(nothing), 0.0));
  EXPECT_EQ(active.largest_gap(at(nothing)), PlaneProblem::infinity);
}

TEST_F(ActiveSetOnAStrip, ReleasesABoundWithWrongSignUntilItIsCycling) {
  const ActiveSetOptions options;
  const std::vector<double> wrong = {0.0, -2.0}, right = {0.0, 2.0};
  active.activate(1, true);
  EXPECT_EQ(active.release_wrong_sign(right, 0.0), ActiveSet::Release::none);
  EXPECT_EQ(active.release_wrong_sign(wrong, 3.0), ActiveSet::Release::none);
  for (int k = 0; k < options.releases; ++k) {
    EXPECT_EQ(active.release_wrong_sign(wrong, 0.0), ActiveSet::Release::released);
    EXPECT_FALSE(active.holds(1));
    active.activate(1, true);
  }
  EXPECT_EQ(active.release_wrong_sign(wrong, 0.0), ActiveSet::Release::cycling);
  EXPECT_TRUE(active.holds(1));
  active.activate(1, false);  // at the lower bound the signs are reversed
  EXPECT_EQ(active.release_wrong_sign(wrong, 0.0), ActiveSet::Release::none);
}

TEST_F(ActiveSetOnAStrip, CountsItsChanges) {
  const int before = active.changes();
  active.activate_violated(at(0.5), 0.0);
  EXPECT_EQ(active.changes(), before);
  active.activate(1, true);
  EXPECT_GT(active.changes(), before);
}

TEST_F(ActiveSetOnAStrip, FindsWhereABoundIsReachedFirst) {
  const ActiveSet::Crossing inside = active.first_crossing(at(0.5), at(0.75));
  EXPECT_EQ(inside.fraction, 1.0);
  EXPECT_EQ(inside.row, -1);
  const ActiveSet::Crossing beyond = active.first_crossing(at(0.5), at(1.5));
  EXPECT_NEAR(beyond.fraction, 0.5, 1e-8);
  EXPECT_EQ(beyond.row, -1);
  const ActiveSet::Crossing arrived = active.first_crossing(at(0.5), at(-1e-10));
  EXPECT_EQ(arrived.fraction, 1.0);
  EXPECT_EQ(arrived.row, 1);
  EXPECT_FALSE(arrived.upper);
}

TEST_F(ActiveSetOnAStrip, IgnoresRowsThatAreNotConsidered) {
  ActiveSet circle(problem, {0});
  EXPECT_FALSE(circle.activate_violated(at(2.0), 0.0));
  EXPECT_DOUBLE_EQ(circle.largest_gap(at(2.0)), 1.5);
  EXPECT_DOUBLE_EQ(circle.largest_left_out(at(2.0)), 1.0);
}

}  // namespace
}  // namespace poise::solvers::active_set_test
