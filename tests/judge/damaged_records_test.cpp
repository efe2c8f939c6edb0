// Damaged records: a part of what poise_damage runs.

#include "tests/judge/damaged_records.hpp"

#include <gtest/gtest.h>

#include "tests/support/seed.hpp"

namespace poise::judge::damaged_records_test {
namespace {

TEST(RandomDamagedRecords, AreBorneOrToldWithTheirCause) {
  ASSERT_GE(damages().size(), 64U);
  // Every fourteenth kind; the rounds of a campaign take them in turn.
  constexpr std::size_t rounds = 14;
  for (std::size_t i = test::campaign_round() % rounds; i < damages().size(); i += rounds) {
    const Damage& damage = damages()[i];
    const JudgedDamage judged = judge_damage(damage, test::seed(1));
    EXPECT_TRUE(judged.is_right(damage)) << damage.bench << ", " << damage.kind << ": " << to_string(judged.outcome)
                                         << ": " << judged.words;
  }
}

}  // namespace
}  // namespace poise::judge::damaged_records_test
