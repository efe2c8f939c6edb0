// poise_rubbing: friction that sticks and slips under loads in time, against small steps that know of no events.
//
//   poise_rubbing FIRST COUNT      judges the random mechanisms of the seeds FIRST ...
//   poise_rubbing --scene SEED     prints the scene of a seed
//
// Prints what is not confirmed and what is apart by more than both errors, which is judged again by shorter steps, and
// a summary. Ends with 1 where something confirmed is apart.

#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/judge/rubbing_campaign.hpp"

int main(int count, char** words) {
  using namespace poise::judge;
  try {
    const std::vector<std::string> given(words + 1, words + count);
    if (given.size() < 2) {
      std::cerr << "poise_rubbing: expected the first seed and a number of seeds, or --scene SEED\n";
      return 2;
    }
    if (given[0] == "--scene") {
      const auto mechanism = rubbing_mechanism(std::stoull(given[1]));
      std::cout << fmt::format("# {} s, accuracy {:g}\n", mechanism->duration, mechanism->accuracy) << mechanism->scene;
      for (std::size_t k = 0; k < mechanism->names.size(); ++k) {
        std::cout << fmt::format("# {} starts at {:.17g} with the rate {:.17g}\n", mechanism->names[k],
                                 mechanism->start[k], mechanism->start_rates[k]);
      }
      return 0;
    }
    const std::uint64_t first = std::stoull(given[0]), seeds = std::stoull(given[1]);
    std::map<std::string, int> runs;
    int confirmed = 0, agree = 0;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      JudgedRubbing run = judge_rubbing(seed);
      for (const int finer : {8, 64, 512}) {
        if (run.beyond > 1) run = judge_rubbing(seed, finer);
      }
      ++runs[run.kind];
      if (!run.confirmed) {
        std::cout << fmt::format("{} {}: not confirmed: {}\n", run.kind, seed, run.why) << std::flush;
        continue;
      }
      ++confirmed;
      if (run.beyond <= 1) {
        ++agree;
        continue;
      }
      std::cout << fmt::format("{} {}: APART by {:.3g}, {:.3g} times both errors ({:.2g} relative, {:.2g}): {}\n",
                               run.kind, seed, run.apart, run.beyond, run.error, run.unknown, run.where)
                << std::flush;
    }
    for (const auto& [kind, times] : runs) std::cout << fmt::format("{}: {}\n", kind, times);
    std::cout << fmt::format("{} mechanisms, {} confirmed, {} of these agree\n", seeds, confirmed, agree);
    return agree < confirmed ? 1 : 0;
  } catch (const std::exception& error) {
    std::cerr << "poise_rubbing: " << error.what() << '\n';
    return 2;
  }
}
