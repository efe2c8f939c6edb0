// Numbers that no data can determine, against 50 digits: a small part of what poise_nulls runs.

#include <cstdint>

#include <gtest/gtest.h>

#include "tests/judge/exact_nulls.hpp"

namespace poise::judge {
namespace {

TEST(RandomNulls, WithholdExactlyWhatANullMovesIn50Digits) {
  int with_nulls = 0;
  int moved = 0;
  int unknowns = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const JudgedNulls judged = judge_nulls(seed);
    EXPECT_TRUE(judged.clear) << seed;
    EXPECT_TRUE(judged.agrees()) << seed << ": " << judged.words;
    EXPECT_FALSE(judged.unclear) << seed << ": " << judged.words;
    with_nulls += judged.nulls > 0;
    moved += judged.moved;
    unknowns += judged.unknowns;
  }
  // Both answers occur often.
  EXPECT_GT(with_nulls, 50);
  EXPECT_LT(with_nulls, 95);
  EXPECT_GT(moved, 300);
  EXPECT_GT(unknowns - moved, 200);
}

}  // namespace
}  // namespace poise::judge
