// Intervals of a snap load that are carried from fits: a small part of what poise_predictions runs.

#include <gtest/gtest.h>

#include "tests/judge/prediction_campaign.hpp"
#include "tests/support/toggle_rig.hpp"

namespace poise::judge::carried_intervals_test {
namespace {

// Of 60 intervals of 95 % fewer than 51 or none beyond it by chance in 0.1 % each: P(misses >= 10) = 0.0006.
TEST(CarriedIntervals, HoldTheSnapLoad) {
  constexpr int fits = 60;
  const double truth = test::rig_snap_load();
  int held = 0;
  double width = 0.0;
  for (int seed = 1; seed <= fits; ++seed) {
    const CarriedFit one = carried_fit(static_cast<std::uint64_t>(seed));
    ASSERT_TRUE(one.why.empty()) << seed << ": " << one.why;
    held += one.low <= truth && truth <= one.high ? 1 : 0;
    width += (one.high - one.low) / fits;
  }
  EXPECT_GE(held, fits - 9);
  EXPECT_LT(width, 0.2 * truth) << "they say something";
}

}  // namespace
}  // namespace poise::judge::carried_intervals_test
