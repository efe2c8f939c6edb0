#include "solvers/interval.hpp"

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/ball.hpp"
#include "tests/support/seed.hpp"

namespace poise::solvers::interval_test {
namespace {

// Random bounds of all sizes and signs; now and then zero, an integer, or a thin interval.
class Operands {
 public:
  Interval interval() {
    const double a = number();
    const double b = random_() % 4 == 0 ? a : (random_() % 3 == 0 ? std::nextafter(a, 1e300) : number());
    return {std::min(a, b), std::max(a, b)};
  }
  // A number of the interval, often one of its ends.
  double inside(const Interval& a) {
    const double share = std::uniform_real_distribution<double>(-0.5, 1.5)(random_);
    return std::clamp(a.lower() + share * (a.upper() - a.lower()), a.lower(), a.upper());
  }
  double number() {
    if (random_() % 16 == 0) return 0.0;
    if (random_() % 8 == 0) return static_cast<double>(static_cast<int>(random_() % 9)) - 4.0;
    const int exponent = static_cast<int>(random_() % 60) - 30;
    const double size = std::ldexp(1.0 + static_cast<double>(random_() % 1000003) / 1000003.0, exponent);
    return random_() % 2 == 0 ? size : -size;
  }

 private:
  std::mt19937_64 random_{test::seed(7)};
};

// The exact result lies in the interval.
void expect_in(const Interval& interval, const Ball& exact, const char* operation) {
  ASSERT_TRUE(Ball(interval.lower()) <= exact && exact <= Ball(interval.upper()))
      << operation << ": " << exact.middle() << " outside by " << (exact - Ball(interval.lower())).middle() << " or "
      << (Ball(interval.upper()) - exact).middle();
}

// Of thin operands: the bounds are neighbours, or equal where the result is a double.
void expect_tight(const Interval& interval, const char* operation, int units = 1) {
  double next = interval.lower();
  for (int k = 0; k < units; ++k) next = std::nextafter(next, std::numeric_limits<double>::infinity());
  ASSERT_LE(interval.upper(), next) << operation;
}

constexpr int cases = 100000;

// By calls that the compiler does not look through: it moves operations across a change of the rounding otherwise.
[[gnu::noinline]] void rounded_up(const std::function<void()>& work) {
  const RoundingUp up;
  work();
}

TEST(Interval, EveryOperationContainsTheExactResult) {
  const Ball::Precision precision(2400);  // exact, next to the smallest doubles too
  Operands draw;
  for (int k = 0; k < cases; ++k) {
    const Interval a = draw.interval();
    const Interval b = draw.interval();
    const double x = draw.inside(a);
    const double y = draw.inside(b);
    Interval sum, difference, product, quotient, squared, negative, root, hulled, size;
    rounded_up([&] {
      sum = a + b;
      difference = a - b;
      product = a * b;
      quotient = a / b;
      squared = square(a);
      negative = -a;
      root = sqrt(a);
      hulled = hull(a, b);
      size = abs(a);
    });
    const Ball p(x);
    const Ball q(y);
    expect_in(sum, p + q, "+");
    expect_in(difference, p - q, "-");
    expect_in(product, p * q, "*");
    if (b.excludes_zero()) expect_in(quotient, p / q, "/");
    expect_in(squared, p * p, "square");
    expect_in(negative, -p, "unary -");
    expect_in(hulled, p, "hull");
    expect_in(size, abs(p), "abs");
    if (x < 0) continue;
    ASSERT_TRUE(Ball(root.lower()) * Ball(root.lower()) <= p && p <= Ball(root.upper()) * Ball(root.upper()));
  }
}

TEST(Interval, WidthAndOrderHoldForAllNumbers) {
  const Ball::Precision precision(2400);  // exact
  Operands draw;
  for (int k = 0; k < cases; ++k) {
    const Interval a = draw.interval();
    const Interval b = draw.interval();
    const double x = draw.inside(a);
    const double y = draw.inside(b);
    double width = 0.0;
    bool meets = false;
    Interval met = a;
    Interval positive, zero;
    rounded_up([&] {
      width = a.width();
      meets = met.meet(b);
      positive = not_below_zero(a);
      zero = with_zero(a);
    });
    ASSERT_TRUE(Ball(width) >= Ball(a.upper()) - Ball(a.lower()));
    expect_in(positive, Ball(std::max(x, 0.0)), "max(x, 0)");
    expect_in(zero, Ball(x), "with zero");
    expect_in(zero, Ball(0.0), "with zero");
    if (b.lower() <= x && x <= b.upper()) {
      ASSERT_TRUE(meets);
      expect_in(met, Ball(x), "meet");
    }
    if (a < b) {
      ASSERT_LT(x, y);
    }
    if (a > b) {
      ASSERT_GT(x, y);
    }
    if (a <= b) {
      ASSERT_LE(x, y);
    }
    if (a >= b) {
      ASSERT_GE(x, y);
    }
    if (a == b) {
      ASSERT_EQ(x, y);
    }
    if (a.excludes_zero()) {
      ASSERT_NE(x, 0.0);
    }
  }
}

TEST(Interval, AFullTurnIsEnclosed) {
  const Ball::Precision precision(300);
  EXPECT_TRUE(sin(Ball(full_turn.lower())) < Ball(0));
  EXPECT_TRUE(sin(Ball(full_turn.upper())) > Ball(0));
  EXPECT_EQ(full_turn.upper(), std::nextafter(full_turn.lower(), 7.0));
}

TEST(Interval, ResultsOfThinOperandsAreNeighbours) {
  Operands draw;
  for (int k = 0; k < cases; ++k) {
    const double x = draw.number();
    const double y = draw.number();
    rounded_up([&] {
      expect_tight(Interval(x) + Interval(y), "+");
      expect_tight(Interval(x) - Interval(y), "-");
      expect_tight(Interval(x) * Interval(y), "*");
      if (y != 0) expect_tight(Interval(x) / Interval(y), "/");
      if (x >= 0) expect_tight(sqrt(Interval(x)), "sqrt", 2);
    });
  }
}

TEST(Interval, ExactResultsStayThin) {
  const RoundingUp up;
  EXPECT_TRUE(Interval(3) * Interval(0.5) == Interval(1.5));
  EXPECT_TRUE(Interval(0) * Interval(-7.25) == Interval(0));
  EXPECT_TRUE(sqrt(Interval(2.25)) == Interval(1.5));
  EXPECT_FALSE(Interval(1) / Interval(3) == Interval(1) / Interval(3));
}

TEST(Interval, SquareOfAnIntervalIsNotNegative) {
  const RoundingUp up;
  const Interval a(-2, 1);
  EXPECT_EQ((a * a).lower(), 0.0);
  EXPECT_EQ((a * Interval(a)).lower(), -2.0);
}

TEST(Interval, DividingByZeroConcludesNothing) {
  const RoundingUp up;
  const Interval all = Interval(1) / Interval(-1, 1);
  EXPECT_FALSE(all.bounded());
  EXPECT_FALSE(all.excludes_zero());
  EXPECT_FALSE((all * Interval(0)).excludes_zero());
  // 0 is among these, whatever stands for 0 times infinity.
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE((Interval(0, 1) * Interval(1, infinity)).excludes_zero());
  EXPECT_FALSE((Interval(1, infinity) * Interval(0, 1)).excludes_zero());
  Interval a(1, 2);
  EXPECT_TRUE(a.meet(all * Interval(0)));
  EXPECT_EQ(a.lower(), 1.0);
  EXPECT_EQ(a.upper(), 2.0);
}

TEST(Interval, SineAndCosineContainTheExactValuesAndAreTight) {
  const Ball::Precision precision(300);
  std::mt19937_64 random(test::seed(3));
  std::uniform_real_distribution<double> angle(-40.0, 40.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int k = 0; k < 30000; ++k) {
    const double a = k % 5 == 0 ? std::round(angle(random)) * std::numbers::pi / 2 : angle(random);
    const double b = a + (k % 3 == 0 ? 0.0 : std::pow(10.0, -16.0 * share(random) + 1.0));
    Interval sine, cosine;
    {
      const RoundingUp up;
      sin_cos(Interval(a, b), sine, cosine);
    }
    const Ball x(std::clamp(a + share(random) * (b - a), a, b));
    expect_in(sine, sin(x), "sine");
    expect_in(cosine, cos(x), "cosine");
    if (a == b) {
      EXPECT_LE(sine.upper() - sine.lower(), 2e-15);
      EXPECT_LE(cosine.upper() - cosine.lower(), 2e-15);
    }
  }
}

TEST(Interval, ExponentialAndLogarithmContainTheExactValuesAndAreTight) {
  const Ball::Precision precision(300);
  std::mt19937_64 random(test::seed(13));
  std::uniform_real_distribution<double> exponent(-720.0, 720.0);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int k = 0; k < 30000; ++k) {
    const double a = k % 4 == 0 ? exponent(random) : (k % 7 == 0 ? 0.0 : exponent(random) / 500);
    const double b = a + (k % 3 == 0 ? 0.0 : std::pow(10.0, -16.0 * share(random) + 1.0));
    const double inside = std::clamp(a + share(random) * (b - a), a, b);
    const double from = std::exp(a), to = std::exp(b);
    const double between = std::clamp(from + share(random) * (to - from), from, to);
    Interval power, logarithm;
    {
      const RoundingUp up;
      power = exp(Interval(a, b));
      if (to < 1e300 && from > 1e-300) logarithm = log(Interval(from, to));
    }
    expect_in(power, exp(Ball(inside)), "exp");
    if (to < 1e300 && from > 1e-300) expect_in(logarithm, log(Ball(between)), "log");
    if (a == b && std::abs(a) < 700) {
      EXPECT_LE(power.upper() - power.lower(), 4e-15 * power.lower());
      EXPECT_LE(logarithm.upper() - logarithm.lower(), 4e-15 * std::max(1.0, std::abs(a)));
    }
  }
}

TEST(Interval, ExponentialAndLogarithmKeepTheirEnds) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const RoundingUp up;
  const Interval all = exp(Interval(-infinity, infinity));
  EXPECT_EQ(all.lower(), 0.0);
  EXPECT_EQ(all.upper(), infinity);
  const Interval from_zero = log(Interval(0.0, 2.0));
  EXPECT_EQ(from_zero.lower(), -infinity);
  EXPECT_NEAR(from_zero.upper(), std::log(2.0), 1e-15);
  EXPECT_LT(log(Interval(0.0, 0.0)).upper(), -600.0);
  EXPECT_EQ(exp(log(Interval(0.0, 0.0))).lower(), 0.0);
  EXPECT_FALSE(exp(Interval::from(NAN, NAN)) < Interval(1e300));
}

// The direction of every vector of the box is that of an angle found, within a turn.
TEST(Interval, AnglesOfABoxContainThoseOfItsVectors) {
  const Ball::Precision precision(200);
  Operands draw;
  int bounded = 0;
  for (int k = 0; k < 30000; ++k) {
    const Interval x = draw.interval();
    const Interval y = draw.interval();
    const double near = 5.0 * std::sin(k);
    Interval angle;
    {
      const RoundingUp up;
      angle = angle_of(x, y, near);
    }
    const double px = draw.inside(x);
    const double py = draw.inside(y);
    if (!angle.bounded() || (px == 0 && py == 0)) continue;
    ++bounded;
    // Turned back by the lower bound the vector must not point to the right of the x axis, and by the upper bound not
    // to its left, for boxes less than half a turn wide.
    const auto across = [&](double by) {
      Ball s, c;
      sin_cos(Ball(by), s, c);
      return c * Ball(py) - s * Ball(px);
    };
    ASSERT_LE(angle.lower(), angle.upper());
    ASSERT_LE(angle.upper() - angle.lower(), std::numbers::pi + 1e-9);
    if (angle.upper() - angle.lower() > 3.0) continue;
    ASSERT_FALSE(across(angle.lower()) < Ball(0)) << px << " " << py;
    ASSERT_FALSE(across(angle.upper()) > Ball(0)) << px << " " << py;
  }
  EXPECT_GT(bounded, 10000);
}

TEST(Interval, ArcsOfCosinesContainThoseOfTheirNumbers) {
  const Ball::Precision precision(200);
  std::mt19937_64 random(36);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int k = 0; k < 30000; ++k) {
    const double size = std::pow(2.0, -static_cast<double>(k % 50));
    const double a = k % 7 == 0 ? 1.0 - size : k % 7 == 1 ? size - 1.0 : number(random);
    const double b = k % 3 == 0 ? a : std::clamp(a + size * number(random), -1.0, 1.0);
    Interval arc;
    {
      const RoundingUp up;
      arc = arc_cosine(Interval(std::min(a, b), std::max(a, b)));
    }
    Ball sine, least, most;
    sin_cos(Ball(arc.lower()), sine, most);
    sin_cos(Ball(arc.upper()), sine, least);
    for (const double c : {a, b}) {
      ASSERT_FALSE(most < Ball(c)) << a << ' ' << b;
      ASSERT_FALSE(least > Ball(c) && arc.upper() < std::numbers::pi) << a << ' ' << b;
    }
    if (a == b && std::abs(a) < 0.9) {
      EXPECT_LE(arc.upper() - arc.lower(), 4e-15);
    }
  }
}

// Of a bound that is not a number nothing is known, nor of what comes of it: comparisons with it prove nothing.
TEST(Interval, BoundsThatAreNotNumbersProveNothing) {
  const RoundingUp up;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Interval other(1.0, 2.0);
  const auto results = [&](const Interval& none) {
    return std::vector<Interval>{none * other,      other * none,      none / other,         none + other, other + none,
                                 hull(none, other), hull(other, none), not_below_zero(none), none};
  };
  for (const Interval& result : results(Interval::from(1.0, nan))) {
    EXPECT_FALSE(result < Interval(1e9));
    EXPECT_FALSE(result.bounded());
    EXPECT_TRUE(std::isnan(result.magnitude()));
  }
  for (const Interval& result : results(Interval::from(nan, 1.0))) {
    EXPECT_FALSE(result > Interval(-1e9));
    EXPECT_FALSE(result.bounded());
    EXPECT_TRUE(std::isnan(result.magnitude()));
  }
}

TEST(RoundingUp, LastsAsLongAsItLives) {
  const int before = std::fegetround();
  {
    const RoundingUp up;
    EXPECT_EQ(std::fegetround(), FE_UPWARD);
  }
  EXPECT_EQ(std::fegetround(), before);
}

}  // namespace
}  // namespace poise::solvers::interval_test
