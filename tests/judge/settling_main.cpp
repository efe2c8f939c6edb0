// poise_settling: where random mechanisms settle, against slow motion in small steps.
//
//   poise_settling one|several FIRST COUNT [EVERY]
//
// Judges the seeds FIRST, FIRST + EVERY, ... below FIRST + COUNT; prints every disagreement and a summary. Exit code 1
// if any is not said to be in doubt.

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/judge/settling_judge.hpp"

int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "poise_settling: expected one|several FIRST COUNT [EVERY]\n");
    return 2;
  }
  const bool one = std::string(argv[1]) == "one";
  const auto first = static_cast<std::uint64_t>(std::atoll(argv[2]));
  const auto count = static_cast<std::uint64_t>(std::atoll(argv[3]));
  const auto every = static_cast<std::uint64_t>(argc > 4 ? std::atoll(argv[4]) : 1);
  int judged = 0, agree = 0, doubtful = 0, wrong = 0;
  std::vector<double> solves;
  for (std::uint64_t seed = first; seed < first + count; seed += every) {
    const auto out = one ? poise::judge::judge_settling_of_one_freedom(seed)
                         : poise::judge::judge_settling_of_several_freedoms(seed);
    ++judged;
    solves.push_back(out.solves);
    doubtful += out.in_doubt;
    if (out.agrees) {
      ++agree;
      continue;
    }
    wrong += !out.in_doubt;
    fmt::print("{} {}: {} freedoms, in doubt {}, margin {:.3g}: {}\n", argv[1], seed, out.freedoms, out.in_doubt,
               out.margin, out.words);
    std::fflush(stdout);
  }
  std::sort(solves.begin(), solves.end());
  const auto part = [&](double p) { return solves[static_cast<std::size_t>(p * static_cast<double>(judged - 1))]; };
  fmt::print(
      "{} judged, {} agree, {} in doubt, {} wrong; time in Newton solves: median {:.1f}, 90 % {:.1f}, 99 % {:.1f}, "
      "most {:.1f}\n",
      judged, agree, doubtful, wrong, part(0.5), part(0.9), part(0.99), part(1.0));
  return wrong > 0 ? 1 : 0;
}
