#include "model/exact_sum.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "solvers/real50.hpp"

namespace poise::exact_sum_test {
namespace {

ExactSum sum_of(const std::vector<double>& terms) {
  ExactSum sum;
  for (const double term : terms) sum.add(term);
  return sum;
}

TEST(ExactSum, OfDoublesThatCancelHasNoParts) {
  EXPECT_TRUE(sum_of({}).parts().empty());
  EXPECT_TRUE(sum_of({0.0, -0.0}).parts().empty());
  EXPECT_TRUE(sum_of({1e16, 1.0, -1e16, -1.0}).parts().empty());
  EXPECT_TRUE(sum_of({0.1, 1e300, 0.2, -0.1, -1e300, -0.2}).parts().empty());
}

TEST(ExactSum, KeepsWhatADoubleLoses) {
  // The doubles nearest to 0.1, 0.2 and 0.3.
  EXPECT_EQ(sum_of({0.1, 0.2, -0.3}).parts(), std::vector<double>{std::ldexp(1.0, -55)});
  EXPECT_EQ(sum_of({1.0, 1e-30}).parts(), (std::vector<double>{1e-30, 1.0}));
  EXPECT_EQ(sum_of({0.25, 0.5}).parts(), std::vector<double>{0.75});
  EXPECT_EQ(sum_of({0.1, 0.2}).to<double>(), 0.1 + 0.2);
}

TEST(ExactSum, IsTheSumIn50Digits) {
  const std::vector<double> terms = {0.1, 1e6, -0.7, 3.3e-7, 12.34, -1e6, 5.5};
  Real50 expected = 0;
  for (const double term : terms) expected += Real50(term);
  EXPECT_EQ(sum_of(terms).to<Real50>(), expected);
  ExactSum less = sum_of(terms);
  less.add(sum_of({0.1, 5.5}), -1.0);
  EXPECT_EQ(less.to<Real50>(), Real50(expected - Real50(0.1) - Real50(5.5)));
  less.add(less, -1.0);
  EXPECT_TRUE(less.parts().empty());
}

TEST(ExactSum, ThatOverflowsIsInfinite) {
  EXPECT_EQ(sum_of({1.7e308, 1.7e308}).to<double>(), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace poise::exact_sum_test
