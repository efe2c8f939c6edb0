// poise_nulls: which unknowns of random experiments are part of a structural null, against 50 digits.
//
//   poise_nulls FIRST COUNT
//
// Judges the seeds FIRST ... FIRST + COUNT - 1; prints every disagreement and a summary. Exit code 1 if there is any.

#include <cstdlib>
#include <exception>

#include <fmt/format.h>

#include "tests/judge/exact_nulls.hpp"

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "poise_nulls: expected FIRST COUNT\n");
    return 2;
  }
  const auto first = static_cast<std::uint64_t>(std::atoll(argv[1]));
  const auto count = static_cast<std::uint64_t>(std::atoll(argv[2]));
  int wrong = 0, unclear = 0, unknowns = 0, nulls = 0, moved = 0, with_nulls = 0, not_exact = 0, failed = 0;
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    poise::judge::JudgedNulls out;
    try {
      out = poise::judge::judge_nulls(seed);
    } catch (const std::exception& error) {
      fmt::print("{}: {}\n", seed, error.what());
      ++failed;
      continue;
    }
    unknowns += out.unknowns;
    nulls += out.nulls;
    moved += out.moved;
    with_nulls += out.nulls > 0;
    unclear += out.unclear;
    not_exact += !out.clear;
    if (out.agrees() && out.clear && !out.unclear) continue;
    wrong += !out.agrees();
    fmt::print("{} {}: {}{}\n", seed, out.agrees() ? "agrees" : "WRONG", out.words,
               out.clear ? "" : "; 50 digits are not clear");
    std::fflush(stdout);
  }
  fmt::print(
      "{} experiments, {} with nulls; {} unknowns, {} of them part of {} nulls; {} disagree, {} unclear, {} unclear in "
      "50 digits, {} failed\n",
      count, with_nulls, unknowns, moved, nulls, wrong, unclear, not_exact, failed);
  return wrong > 0 ? 1 : 0;
}
