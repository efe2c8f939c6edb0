// Every operation encloses its result, against 50 digits.

#include "solvers/ball.hpp"

#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/solvers/exact_balls.hpp"
#include "tests/support/seed.hpp"

namespace poise::solvers::ball_test {
namespace {

struct Random {
  // Of either sign, over many magnitudes.
  double operator()() {
    const int exponent = magnitude(engine);
    return std::ldexp(uniform(engine), exponent);
  }

  std::mt19937 engine{static_cast<unsigned>(test::seed(11))};
  std::uniform_real_distribution<double> uniform{-1.0, 1.0};
  std::uniform_int_distribution<int> magnitude{-20, 10};
};

class BallOf : public testing::TestWithParam<long> {
 protected:
  Ball::Precision precision_{GetParam()};
};

TEST_P(BallOf, ResultsContainsTheExactOnes) {
  Random random;
  for (int k = 0; k < 500; ++k) {
    const double a = random();
    const double b = random();
    const Real50 x = a;
    const Real50 y = b;
    EXPECT_TRUE(encloses(Ball(a) + Ball(b), x + y)) << a << ", " << b;
    EXPECT_TRUE(encloses(Ball(a) - Ball(b), x - y)) << a << ", " << b;
    EXPECT_TRUE(encloses(Ball(a) * Ball(b), x * y));
    EXPECT_TRUE(encloses(Ball(a) / Ball(b), x / y)) << a << ", " << b;
    EXPECT_TRUE(encloses(sin(Ball(a)), sin(x))) << a;
    EXPECT_TRUE(encloses(cos(Ball(a)), cos(x))) << a;
    EXPECT_TRUE(encloses(sqrt(abs(Ball(a))), sqrt(abs(x)))) << a;
    Ball sine, cosine;
    sin_cos(Ball(a), sine, cosine);
    EXPECT_TRUE(encloses(sine, sin(x)) && encloses(cosine, cos(x))) << a;
    Ball left = Ball(1) / Ball(3);
    left.subtract_product(Ball(a), Ball(b));
    EXPECT_TRUE(encloses(left, Real50(1) / 3 - x * y)) << a << ", " << b;
  }
}

// Also with midpoints of a double, where every operation rounds.
INSTANTIATE_TEST_SUITE_P(Bits, BallOf, testing::Values(53, 64, 128), testing::PrintToStringParamName());

TEST(Ball, OfManyNumbersContainsTheResultsOfAllOfThem) {
  Random random;
  for (int k = 0; k < 300; ++k) {
    const double a = random();
    const double b = random();
    const double wide_a = 0.1 * std::abs(random());
    const double wide_b = 0.1 * std::abs(random());
    const Ball x = Ball(a).widened(wide_a);
    const Ball y = Ball(b).widened(wide_b);
    for (int draw = 0; draw < 10; ++draw) {
      const Real50 p = Real50(a) + Real50(wide_a) * random.uniform(random.engine);
      const Real50 q = Real50(b) + Real50(wide_b) * random.uniform(random.engine);
      EXPECT_TRUE(encloses(x, p));
      EXPECT_TRUE(encloses(x + y, p + q));
      EXPECT_TRUE(encloses(x * y, p * q));
      EXPECT_TRUE(encloses(sin(x), sin(p)));
      EXPECT_TRUE(encloses(cos(x), cos(p)));
      if (!y.contains_zero()) {
        EXPECT_TRUE(encloses(x / y, p / q));
      }
    }
  }
}

TEST(Ball, OfADoubleIsExact) {
  for (const double x : {0.0, 0.1, -1e300, 0x1p-1074, 3.0}) {
    EXPECT_EQ(Ball(x).radius(), 0.0);
    EXPECT_EQ(Ball(x).middle(), x);
    EXPECT_TRUE(Ball(x) == Ball(x));
  }
}

TEST(Ball, OfRoundedInputContainsAllNumbersThatRoundToIt) {
  Random random;
  for (int k = 0; k < 200; ++k) {
    const double x = random();
    const Ball exact(x);
    const Ball rounded = [&] {
      const Ball::InputRounding guard(true);
      EXPECT_EQ(Ball(7).radius(), 0.0) << "integers remain exact";
      return Ball(x);
    }();
    const double up = std::nextafter(x, 2 * x);
    const double down = std::nextafter(x, 0.0);
    EXPECT_TRUE(encloses(rounded, (Real50(x) + Real50(up)) / 2 * (1 - Real50(1e-40))));
    EXPECT_TRUE(rounded.contains(exact));
    EXPECT_LE(rounded.radius(), 1.000001 * 0x1p-53 * std::abs(x));
    EXPECT_FALSE(encloses(rounded, Real50(up))) << "the next double is another number";
    EXPECT_TRUE(x == down || !encloses(rounded, Real50(x) - 2 * (Real50(x) - Real50(down))));
  }
  const Ball::InputRounding guard(true);
  EXPECT_TRUE(encloses(Ball(0.1), Real50(1) / 10));
  {
    const Ball::InputRounding off(false);
    EXPECT_FALSE(encloses(Ball(0.1), Real50(1) / 10));
  }
  EXPECT_TRUE(encloses(Ball(0.1), Real50(1) / 10)) << "as before";
}

TEST(Ball, WithoutAResultIsNotFinite) {
  const Ball around_zero = Ball(0.1).widened(0.2);
  EXPECT_FALSE((Ball(1) / around_zero).is_finite());
  EXPECT_FALSE((Ball(1) / Ball(0)).is_finite());
  EXPECT_FALSE(sqrt(around_zero).is_finite());
  EXPECT_FALSE(sqrt(Ball(-1)).is_finite());
  EXPECT_FALSE(Ball(std::numeric_limits<double>::quiet_NaN()).is_finite());
  EXPECT_FALSE(Ball(std::numeric_limits<double>::infinity()).is_finite());
  EXPECT_TRUE(sqrt(Ball(0)).is_finite());
}

TEST(Ball, OrderHoldsForAllNumbersOrIsFalse) {
  const Ball one = Ball(1).widened(0.5);
  const Ball two = Ball(2).widened(0.25);
  const Ball between = Ball(1.5).widened(0.25);
  EXPECT_TRUE(one < two && two > one && one <= two && two >= one);
  EXPECT_FALSE(one < between || one > between || one == between);
  EXPECT_FALSE(one == one) << "two numbers of it may differ";
  EXPECT_TRUE(Ball(0).widened(1e-300).contains_zero());
  EXPECT_FALSE(Ball(1e-300).contains_zero());
}

TEST(Ball, BoundsAreRoundedOutwards) {
  Random random;
  for (int k = 0; k < 200; ++k) {
    const double a = random();
    const double wide = std::abs(random());
    const Ball x = (Ball(a) / Ball(3)).widened(wide);
    const Real50 middle = Real50(a) / 3;
    EXPECT_GE(Real50(x.greatest()), (abs(middle) + wide) * (1 - Real50(1e-36)));
    EXPECT_LE(Real50(x.least()), abs(abs(middle) - wide) * (1 + Real50(1e-36)));
    EXPECT_GE(x.radius(), wide);
    EXPECT_LE(x.greatest(), 1.000001 * (std::abs(a) / 3 + wide));
    EXPECT_EQ(x.least() == 0.0, x.contains_zero());
  }
}

TEST(Ball, ContainsAndJoins) {
  const Ball outer = Ball(1).widened(0.5);
  EXPECT_TRUE(outer.contains(Ball(1.5)));
  EXPECT_TRUE(outer.contains(Ball(1.25).widened(0.24)));
  EXPECT_FALSE(outer.contains(Ball(1.5).widened(1e-6)));
  const Ball both = Ball::of_both(Ball(-1), Ball(3));
  EXPECT_TRUE(both.contains(Ball(-1)) && both.contains(Ball(3)));
  EXPECT_LE(both.radius(), 2.000001);
  EXPECT_EQ(both.midpoint().radius(), 0.0);
  EXPECT_NEAR(both.middle(), 1.0, 1e-6);
}

}  // namespace
}  // namespace poise::solvers::ball_test
