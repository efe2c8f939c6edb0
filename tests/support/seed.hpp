#pragma once

#include <cstdint>
#include <cstdlib>

namespace poise::test {

/// Round of `make campaign` (POISE_CAMPAIGN = 1, 2, ...), 0 in `make test`.
inline std::uint64_t campaign_round() {
  const char* const round = std::getenv("POISE_CAMPAIGN");
  return round == nullptr ? 0 : std::strtoull(round, nullptr, 10);
}

/// Seed of a random test: the one given in `make test`, and another in each round of a campaign.
inline std::uint64_t seed(std::uint64_t given) { return given + 1'000'003 * campaign_round(); }

/// Number of cases of a random test: those of the sample in `make test`, and those of each round of a campaign.
inline int cases(int sample, int of_round) { return campaign_round() == 0 ? sample : of_round; }

}  // namespace poise::test
