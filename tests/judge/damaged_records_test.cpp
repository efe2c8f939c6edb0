// Damaged records: a part of what poise_damage runs.

#include "tests/judge/damaged_records.hpp"

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::judge::damaged_records_test {
namespace {

TEST(RandomDamagedRecords, AreBorneOrToldWithTheirCause) {
  ASSERT_GE(damages().size(), 64U);
  // Every seventh kind, in each round of a campaign other ones.
  const std::size_t first = test::campaign_round() % 7;
  for (std::size_t i = first; i < damages().size(); i += 7) {
    const Damage& damage = damages()[i];
    const JudgedDamage judged = judge_damage(damage, test::seed(1));
    EXPECT_TRUE(judged.is_right(damage)) << damage.bench << ", " << damage.kind << ": " << to_string(judged.outcome)
                                         << ": " << judged.words;
  }
}

}  // namespace
}  // namespace poise::judge::damaged_records_test
