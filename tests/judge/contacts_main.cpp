// poise_contacts: motion with contact of random mechanisms, as the program computes it, against small steps that know
// of no events. It runs the program and reads only what that writes.
//
//   poise_contacts PROGRAM FOLDER FIRST COUNT      judges the random mechanisms of the seeds FIRST ...; files in FOLDER
//   poise_contacts --events PROGRAM FOLDER FIRST COUNT   watches every event of motions that are 25 times as long
//   poise_contacts --scene SEED                    prints the scene of a seed and how it starts
//
// Prints what is not confirmed, what is refused, and what is apart by more than both errors, which is judged again by
// shorter steps, and a summary. Ends with 1 where something confirmed is apart.

#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/judge/contact_campaign.hpp"

namespace {
using namespace poise::judge;

constexpr double longer = 25.0;

/// Energy may not grow in an event, nor a gap be below zero by more than the error that is printed.
int watch(const std::vector<std::string>& given) {
  const std::uint64_t first = std::stoull(given[3]), seeds = std::stoull(given[4]);
  long events = 0, impacts = 0;
  int wrong = 0;
  std::map<int, int> exits;
  WatchedEvents worst;
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    const WatchedEvents run = watch_events(seed, given[1], given[2], longer);
    ++exits[run.exit_code];
    events += run.events;
    impacts += run.impacts;
    if (!run.confirmed) {
      std::cout << fmt::format("{} {}: exit {}: {}\n", run.kind, seed, run.exit_code, run.why) << std::flush;
      continue;
    }
    if (run.passed > worst.passed) worst = run;
    if (run.passed <= 1.0 && run.gained <= 1e-9) continue;
    ++wrong;
    std::cout << fmt::format("{} {}: PASSED {} by {:.3g}, {:.3g} times its error; gained {:.3g}\n", run.kind, seed,
                             run.where, run.depth, run.passed, run.gained)
              << std::flush;
  }
  for (const auto& [code, times] : exits) std::cout << fmt::format("exit {}: {}\n", code, times);
  std::cout << fmt::format(
      "{} events, {} of them impacts; {} motions passed a stop or gained energy; the deepest is "
      "{:.3g}, {:.3g} times the error\n",
      events, impacts, wrong, worst.depth, worst.passed);
  return wrong > 0 ? 1 : 0;
}

}  // namespace

int main(int count, char** words) {
  try {
    const std::vector<std::string> given(words + 1, words + count);
    if (given.size() == 2 && given[0] == "--scene") {
      const auto mechanism = contact_mechanism(std::stoull(given[1]));
      std::cout << fmt::format("# {}, {:.17g} s, accuracy {:g}\n", mechanism->kind, mechanism->duration,
                               mechanism->accuracy)
                << mechanism->scene;
      for (std::size_t k = 0; k < mechanism->names.size(); ++k) {
        std::cout << fmt::format("# --release-rate {}={:.17g}\n", mechanism->names[k], mechanism->start_rates[k]);
      }
      return 0;
    }
    if (given.size() == 5 && given[0] == "--events") return watch(given);
    if (given.size() < 4) {
      std::cerr << "poise_contacts: expected [--events] PROGRAM FOLDER FIRST COUNT, or --scene SEED\n";
      return 2;
    }
    const std::uint64_t first = std::stoull(given[2]), seeds = std::stoull(given[3]);
    std::map<std::string, int> runs;
    int confirmed = 0, agree = 0, marked = 0, unjudged = 0, impacts = 0;
    std::map<int, int> exits;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      JudgedContacts run = judge_contacts(seed, given[0], given[1]);
      for (const double finer : {4.0, 16.0}) {
        if (run.beyond > 1) run = judge_contacts(seed, given[0], given[1], finer);
      }
      ++runs[run.kind];
      ++exits[run.exit_code];
      if (!run.confirmed) {
        std::cout << fmt::format("{} {}: exit {}: {}\n", run.kind, seed, run.exit_code, run.why) << std::flush;
        continue;
      }
      ++confirmed;
      if (!run.judged) {
        ++unjudged;
        std::cout << fmt::format("{} {}: {}\n", run.kind, seed, run.why) << std::flush;
        continue;
      }
      impacts += run.impacts;
      marked += run.until ? 1 : 0;
      if (run.beyond <= 1) {
        ++agree;
        continue;
      }
      std::cout << fmt::format("{} {}: APART by {:.3g}, {:.3g} times both errors ({:.2g} relative, {:.2g}): {}\n",
                               run.kind, seed, run.apart, run.beyond, run.error, run.unknown, run.where)
                << std::flush;
    }
    for (const auto& [kind, times] : runs) std::cout << fmt::format("{}: {}\n", kind, times);
    for (const auto& [code, times] : exits) std::cout << fmt::format("exit {}: {}\n", code, times);
    std::cout << fmt::format(
        "{} mechanisms with {} impacts, {} confirmed, {} of these agree, {} were not judged, {} have an event that is "
        "not unique\n",
        seeds, impacts, confirmed, agree, unjudged, marked);
    return agree + unjudged < confirmed ? 1 : 0;
  } catch (const std::exception& error) {
    std::cerr << "poise_contacts: " << error.what() << '\n';
    return 2;
  }
}
