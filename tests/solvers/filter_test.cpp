#include "solvers/filter.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace poise::solvers::filter_test {
namespace {

TEST(Filter, TakesWhatIsBetterInGapOrInForce) {
  Filter filter;
  EXPECT_TRUE(filter.takes(1.0, 1.0));
  filter.remember(1.0, 1.0);
  EXPECT_TRUE(filter.takes(0.9, 5.0));
  EXPECT_TRUE(filter.takes(5.0, 0.9));
  EXPECT_FALSE(filter.takes(0.995, 0.995));
  filter.remember(0.5, 5.0);
  EXPECT_FALSE(filter.takes(0.9, 6.0));
  filter.clear();
  EXPECT_TRUE(filter.takes(0.9, 6.0));
}

TEST(Filter, SmallGapsAreAllAlike) {
  Filter filter({.closed_within = 1e-3});
  filter.remember(1e-4, 1.0);
  EXPECT_FALSE(filter.takes(1e-9, 1.0));
}

TEST(Filter, NeverTakesWhatIsNotFinite) {
  const Filter filter;
  EXPECT_FALSE(filter.takes(std::numeric_limits<double>::quiet_NaN(), 0.0));
  EXPECT_FALSE(filter.takes(0.0, std::numeric_limits<double>::infinity()));
}

TEST(Filter, ForgetsTheOldestPointBeyondItsSize) {
  Filter filter({.size = 2});
  filter.remember(1.0, 1.0);
  EXPECT_FALSE(filter.takes(1.0, 1.0));
  filter.remember(9.0, 9.0);
  filter.remember(8.0, 8.0);
  EXPECT_TRUE(filter.takes(1.0, 1.0));
}

}  // namespace
}  // namespace poise::solvers::filter_test
