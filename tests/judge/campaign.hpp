#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/judge/judge.hpp"

namespace poise::judge {

/// One answer of the program for a random scene, judged.
struct JudgedAnswer {
  std::string method;
  bool confirmed = false;
  Verdict verdict = Verdict::undecided;
  std::optional<double> tightness;  ///< claimed radius over distance (at least a rounding unit), of right answers
  std::string why;
};

/// Four answers for the scene of a family and seed: virtual work for the nearest and for a stable equilibrium, minimum
/// energy by Ipopt, and another method, in turn with the seed. An answer is empty (not confirmed, right, with the
/// reason in `why`) where the program reports that the scene cannot be assembled.
std::vector<JudgedAnswer> judge_answers(const std::string& family, std::uint64_t seed);

}  // namespace poise::judge
