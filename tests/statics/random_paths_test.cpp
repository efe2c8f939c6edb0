// Load paths of random mechanisms; poise_path_campaign runs more of them.

#include <gtest/gtest.h>

#include "tests/judge/path_campaign.hpp"
#include "tests/support/seed.hpp"

namespace poise::random_paths_test {
namespace {

TEST(RandomPaths, AreTheSameWithShorterSteps) {
  int traced = 0, points = 0, unproved = 0;
  for (std::uint64_t k = 1; k <= 60; ++k) {
    const std::uint64_t seed = test::seed(k);
    const judge::JudgedPath judged = judge::judge_path(seed, seed % 4 == 3, seed % 4 == 1, 0);
    // A curve that ends at a dead centre ends elsewhere with other steps.
    EXPECT_TRUE(judged.retraced || !judged.traced) << seed << ": " << judged.differences;
    traced += judged.traced;
    points += judged.points;
    unproved += judged.unproved;
  }
  EXPECT_GE(traced, 54);
  // Next to dead centres proofs fail, and points say so.
  EXPECT_LE(unproved, points / 100);
}

}  // namespace
}  // namespace poise::random_paths_test
