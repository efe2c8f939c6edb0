// Progressive bump stops and springs given by a preload: closed forms, sides, and smoothness where contact begins.

#include "model/laws/bump_stop.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "model/laws/preloaded_spring.hpp"
#include "solvers/ball.hpp"
#include "solvers/real50.hpp"

namespace poise::bump_stop_test {
namespace {

using Acts = BumpStop::Acts;

// 80 N at the depth 0.02 beyond 0.3, cubic.
BumpStop rubber(Acts acts) { return {80.0, 0.3, 0.02, 3.0, acts}; }

TEST(BumpStop, IsAPowerOfThePenetration) {
  const BumpStop stop = rubber(Acts::compression);
  EXPECT_NEAR(stop.at_rest(0.28).value, -80.0, 1e-11);
  EXPECT_NEAR(stop.at_rest(0.29).value, -10.0, 1e-12);
  EXPECT_NEAR(stop.at_rest(0.28).by_measure, 3 * 80 / 0.02, 1e-8);
  EXPECT_NEAR(stop.energy(0.28), 80 * 0.02 / 4, 1e-14);
  EXPECT_EQ(stop.at_rest(0.3).value, 0.0);
  EXPECT_EQ(stop.at_rest(0.5).value, 0.0);
  EXPECT_EQ(stop.at_rest(0.5).by_measure, 0.0);
  EXPECT_EQ(stop.energy(0.5), 0.0);
  EXPECT_TRUE(stop.slack(0.5));
  EXPECT_FALSE(stop.slack(0.29));
}

TEST(BumpStop, ActsOnTheSideThatIsAskedFor) {
  for (const double u : {-0.03, -0.01, 0.01, 0.03}) {
    const double both = rubber(Acts::both).at_rest(0.3 + u).value;
    EXPECT_NEAR(both, 80 * std::pow(u / 0.02, 3), 1e-10);
    EXPECT_EQ(rubber(Acts::tension).at_rest(0.3 + u).value, u > 0 ? both : 0.0);
    EXPECT_EQ(rubber(Acts::compression).at_rest(0.3 + u).value, u < 0 ? both : 0.0);
  }
}

// Force and slope begin at zero, also with a low exponent.
TEST(BumpStop, HasNoKinkWhereContactBegins) {
  for (const double p : {1.25, 2.0, 3.5}) {
    const BumpStop stop{80.0, 0.3, 0.02, p, Acts::compression};
    const LawForce<Real50> at = stop.at_rest(Real50(Real50(0.3) - Real50("1e-30")));
    EXPECT_LT(abs(at.value), 1e-15) << p;
    EXPECT_LT(abs(at.by_measure), 1e-3) << p;
  }
}

TEST(BumpStop, EnclosesTheForcesOfABall) {
  using solvers::Ball;
  for (const Acts acts : {Acts::compression, Acts::tension, Acts::both}) {
    const BumpStop of = rubber(acts);
    for (const double middle : {0.2, 0.29, 0.31}) {
      for (const double share : {-0.9, 0.0, 0.9}) {
        const Ball g = Ball(middle).widened(1e-3);
        const Ball inside(middle + share * 1e-3);
        EXPECT_TRUE(of.at_rest(g).value.contains(of.at_rest(inside).value)) << middle;
        EXPECT_TRUE(of.at_rest(g).by_measure.contains(of.at_rest(inside).by_measure)) << middle;
      }
    }
  }
}

TEST(PreloadedSpring, IsTheLinearSpringOfThatFreeLength) {
  const PreloadedSpring spring{40.0, 12.0, 1.5};  // of free length 1.2
  const LinearSpring same{40.0, 1.2, LinearSpring::Acts::both};
  for (const double g : {-1.0, 1.2, 1.5, 3.0}) {
    EXPECT_NEAR(spring.at_rest(g).value, same.at_rest(g).value, 1e-13);
    EXPECT_EQ(spring.at_rest(g).by_measure, 40.0);
    EXPECT_NEAR(spring.energy(g) - spring.energy(1.5), same.energy(g) - same.energy(1.5), 1e-13);
  }
  EXPECT_EQ(spring.at_rest(1.5).value, 12.0);
  EXPECT_EQ(spring.energy(1.5), 0.0);
}

}  // namespace
}  // namespace poise::bump_stop_test
