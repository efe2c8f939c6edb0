#include "identification/fit/autocorrelation.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace poise::autocorrelation_test {
namespace {

TEST(Autocorrelation, IsThatOfNeighbours) {
  const auto of = [](const std::vector<double>& time, const std::vector<double>& e) {
    return autocorrelation(time, e);
  };
  EXPECT_NEAR(of({0, 1, 2, 3}, {1, 2, 3, 4}).value, (2.0 + 6 + 12) / (1 + 4 + 9 + 16), 1e-15);
  EXPECT_EQ(of({0, 1, 2, 3}, {1, 2, 3, 4}).pairs, 3);
  EXPECT_NEAR(autocorrelation({0, 1, 2, 3}, {1, 2, 3, 4}, 2).value, (3.0 + 8) / (1 + 4 + 9 + 16), 1e-15);
  EXPECT_EQ(autocorrelation({0, 1, 2, 3, 5}, {1, 2, 3, 4, 5}, 2).pairs, 2) << "from 2 to 5 a reading is missing";
  EXPECT_TRUE(std::isnan(autocorrelation({0, 1}, {1, 2}, 2).value));
  EXPECT_EQ(of({0, 1, 2}, {0, 0, 0}).value, 0.0);
  EXPECT_TRUE(std::isnan(of({}, {}).value));
  EXPECT_TRUE(std::isnan(of({1}, {2}).value));
}

// Residuals of a first-order process of which parts were not read: neighbours across a part have no correlation.
TEST(Autocorrelation, DoesNotCountPairsAcrossMissingReadings) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> time, e;
  double x = 0.0;
  for (int i = 0; i < 200'000; ++i) {
    x = 0.9 * x + std::sqrt(1 - 0.81) * normal(random);
    if (i % 50 < 3) {  // three readings, then none for long
      time.push_back(0.01 * i);
      e.push_back(x);
    }
  }
  const Autocorrelation found = autocorrelation(time, e);
  EXPECT_EQ(found.pairs, 8000);
  EXPECT_NEAR(found.value, 0.9, 0.02);
}

}  // namespace
}  // namespace poise::autocorrelation_test
