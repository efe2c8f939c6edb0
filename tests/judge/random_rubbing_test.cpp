// Friction that sticks and slips under loads in time: a small part of what poise_rubbing runs.

#include <cstdint>

#include <gtest/gtest.h>

#include "tests/judge/rubbing_campaign.hpp"
#include "tests/support/seed.hpp"

namespace poise::judge::random_rubbing_test {
namespace {

TEST(RandomRubbing, AgreesWithSmallStepsThatKnowNoEvents) {
  const int cases = test::cases(40, 1000);
  int confirmed = 0;
  for (int k = 1; k <= cases; ++k) {
    const std::uint64_t seed = test::seed(static_cast<std::uint64_t>(k));
    JudgedRubbing run = judge_rubbing(seed);
    if (run.beyond > 1) run = judge_rubbing(seed, 8);
    EXPECT_LE(run.beyond, 1.0) << run.kind << " " << seed << ": apart by " << run.apart << ", errors " << run.error
                               << " and " << run.unknown << ", " << run.where;
    confirmed += run.confirmed ? 1 : 0;
    if (!run.confirmed) RecordProperty("not_confirmed", run.kind + " " + std::to_string(seed) + ": " + run.why);
  }
  EXPECT_GE(1000 * confirmed, 995 * cases);
}

}  // namespace
}  // namespace poise::judge::random_rubbing_test
