// Numbers that no data can determine, against 50 digits: a small part of what poise_nulls runs.

#include <cstdint>

#include <gtest/gtest.h>

#include "tests/judge/exact_nulls.hpp"
#include "tests/support/seed.hpp"

namespace poise::judge::random_nulls_test {
namespace {

TEST(RandomNulls, WithholdExactlyWhatANullMovesIn50Digits) {
  int unclear = 0;
  int with_nulls = 0;
  int moved = 0;
  int unknowns = 0;
  for (std::uint64_t k = 1; k <= 100; ++k) {
    const std::uint64_t seed = test::seed(k);
    const JudgedNulls judged = judge_nulls(seed);
    if (!judged.clear) {  // 50 digits do not tell
      ++unclear;
      continue;
    }
    EXPECT_TRUE(judged.agrees()) << seed << ": " << judged.words;
    EXPECT_FALSE(judged.unclear) << seed << ": " << judged.words;
    with_nulls += judged.nulls > 0;
    moved += judged.moved;
    unknowns += judged.unknowns;
  }
  EXPECT_LE(unclear, 2);
  // Both answers occur often.
  EXPECT_GT(with_nulls, 50);
  EXPECT_LT(with_nulls, 95);
  EXPECT_GT(moved, 300);
  EXPECT_GT(unknowns - moved, 200);
}

// Columns that are rounding only - in one state, or the same at numbers near by -, tanh of friction near 1, and a part
// of 5e-5 in a null space known to 2e-6.
TEST(RandomNulls, NothingFreeIsSaidToBeKnown) {
  for (const std::uint64_t seed : {604, 1501, 3181, 4508, 4768, 5196, 8562, 11093, 11872}) {
    const JudgedNulls judged = judge_nulls(seed);
    EXPECT_GT(judged.moved, 0) << seed;
    EXPECT_EQ(judged.false_claims, 0) << seed << ": " << judged.words;
  }
}

// Effects of 1e-15 to 1e-10 of others, which rounding of doubles hides, and null spaces that it moves by more than
// 1e-6.
TEST(RandomNulls, NothingIsWithheldForRoundingOfDoubles) {
  for (const std::uint64_t seed : {873, 1392, 1580, 2162, 3219, 5129, 5593, 6558, 7050, 11915}) {
    const JudgedNulls judged = judge_nulls(seed);
    EXPECT_TRUE(judged.agrees()) << seed << ": " << judged.words;
    EXPECT_FALSE(judged.unclear) << seed << ": " << judged.words;
  }
}

}  // namespace
}  // namespace poise::judge::random_nulls_test
