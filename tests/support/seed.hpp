#pragma once

#include <cstdint>
#include <cstdlib>

namespace poise::test {

/// Seed of a random test: the one given in `make test`, and another in each round of `make campaign` (POISE_CAMPAIGN =
/// 1, 2, ...).
inline std::uint64_t seed(std::uint64_t given) {
  const char* const round = std::getenv("POISE_CAMPAIGN");
  return round == nullptr ? given : given + 1'000'003 * std::strtoull(round, nullptr, 10);
}

}  // namespace poise::test
