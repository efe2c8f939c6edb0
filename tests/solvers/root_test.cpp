#include "solvers/root.hpp"

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

namespace poise::solvers::root_test {
namespace {

constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();

TEST(Root, BisectionEndsBetweenNeighbouringNumbers) {
  Bracket bracket{1.0, 2.0};
  bisect(bracket, [](double x) { return x * x < 2.0; });
  EXPECT_EQ(std::nextafter(bracket.from, 2.0), bracket.to);
  EXPECT_LT(bracket.from * bracket.from, 2.0);
  EXPECT_GE(bracket.to * bracket.to, 2.0);
}

TEST(Root, BisectionMayRunDownwards) {
  Bracket bracket{2.0, 1.0};
  bisect(
      bracket, [](double x) { return x * x > 2.0; }, [](const Bracket& at) { return at.width() <= 1e-6; });
  EXPECT_GT(bracket.from, bracket.to);
  EXPECT_NEAR(bracket.from, std::sqrt(2.0), 1e-6);
  EXPECT_LE(bracket.width(), 1e-6);
}

TEST(Root, BisectionEndsWhereNothingIsKnown) {
  Bracket bracket{0.0, 1.0};
  int asked = 0;
  bisect(bracket, [&](double) { return asked++ < 2 ? std::optional<bool>(true) : std::nullopt; });
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(bracket.from, 0.75);
  EXPECT_EQ(bracket.to, 1.0);
}

TEST(Root, BisectionTakesThePlaceItIsMovedTo) {
  Bracket bracket{0.0, 1.0};
  bisect(
      bracket,
      [](double& x) {
        x += 0.125;
        return false;
      },
      [](const Bracket& at) { return at.width() < 1.0; });
  EXPECT_EQ(bracket.to, 0.625);
}

TEST(Root, SecantsFindWhereACosineIsItsArgument) {
  const auto f = [](double x) { return std::optional(std::cos(x) - x); };
  const auto root = root_by_secants(f, {0.0, 1.0}, 1.0, std::cos(1.0) - 1.0, 1e-15);
  ASSERT_TRUE(root);
  EXPECT_NEAR(*root, 0.73908513321516064, rounding);
}

// An end that stays would keep plain regula falsi from converging: it takes some 10^4 steps here.
TEST(Root, SecantsConvergeOnAFlatSide) {
  int steps = 0;
  const auto f = [&](double x) {
    ++steps;
    return std::optional(std::pow(x, 9) - 1e-3);
  };
  const auto root = root_by_secants(f, {0.0, 1.0}, -1e-3, 1.0 - 1e-3, 1e-15);
  ASSERT_TRUE(root);
  EXPECT_NEAR(*root, std::pow(1e-3, 1.0 / 9), 1e-13);
  EXPECT_LT(steps, 40);
}

TEST(Root, NewtonFindsARisingAndAFallingRoot) {
  for (const double sign : {1.0, -1.0}) {
    const auto f = [&](double x) { return std::optional(ValueAndSlope{sign * (x * x - 2.0), sign * 2.0 * x}); };
    const auto root = root_by_newton(f, {0.0, 10.0}, 10.0, sign < 0.0);
    ASSERT_TRUE(root);
    EXPECT_NEAR(*root, std::sqrt(2.0), rounding);
  }
}

// From 2 on plain Newton's method runs away from the root of atan.
TEST(Root, NewtonIsKeptInTheBracket) {
  const auto f = [](double x) { return std::optional(ValueAndSlope{std::atan(x), 1.0 / (1.0 + x * x)}); };
  const auto root = root_by_newton(f, {-5.0, 4.0}, 4.0, false);
  ASSERT_TRUE(root);
  EXPECT_NEAR(*root, 0.0, 1e-15);
}

TEST(Root, ThereIsNoneWhereTheFunctionHasNoValue) {
  EXPECT_FALSE(root_by_secants([](double) { return std::optional<double>(); }, {0.0, 1.0}, -1.0, 1.0, 1e-15));
  EXPECT_FALSE(root_by_newton([](double) { return std::optional<ValueAndSlope>(); }, {0.0, 1.0}, 0.5, false));
}

}  // namespace
}  // namespace poise::solvers::root_test
