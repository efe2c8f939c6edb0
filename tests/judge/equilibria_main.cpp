// poise_equilibria: complete sets of equilibria of random linkages against other ways to them.
//
//   poise_equilibria FIRST COUNT [--kind four_bar|watt|stephenson] [--starts N] [--work W] [--springs N]
//                    [--torsion N] [--zero] [--one-way SHARE] [--phc] [--paths]
//   poise_equilibria FIRST COUNT --mixed [--kind chain|slider_crank|slotted_lever|linkage] [--starts N] [--work W]
//   poise_equilibria FIRST COUNT --kind FAMILY [--starts N] [--work W]
//   poise_equilibria FIRST COUNT --planted [--couplings] [--starts N] [--work W]
//
// FIRST is the first seed. Without --kind the kinds alternate. --zero: springs have free length zero. --mixed:
// mechanisms with slides, stops, one-way springs, forces and torques, half of them with round numbers. FAMILY: one of
// tests/support/random_scenes.hpp. --planted: mechanisms drawn around an equilibrium (tests/support/
// random_mechanism.hpp), with joints and springs of every kind, up to two loops, some of which repeat others, half of
// them with stops, some with loads that follow bodies, --couplings: all with gears, cams and other couplings. --print:
// the scenes too. Prints the contradictions and what is not proved, each with its seed, and a summary. Ends with 1
// where something contradicts.

#include <algorithm>
#include <cstdint>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "tests/judge/equilibria_campaign.hpp"
#include "tests/support/mixed_mechanisms.hpp"
#include "tests/support/random_linkages.hpp"
#include "tests/support/random_scenes.hpp"

int main(int count, char** words) {
  using namespace poise;
  try {
    const std::vector<std::string> given(words + 1, words + count);
    const auto has = [&](const std::string& name) {
      return std::find(given.begin(), given.end(), name) != given.end();
    };
    const auto value = [&](const std::string& name, const std::string& otherwise) {
      const auto at = std::find(given.begin(), given.end(), name);
      return at == given.end() || at + 1 == given.end() ? otherwise : *(at + 1);
    };
    if (given.size() < 2) {
      std::cerr << "poise_equilibria: expected the first seed and a number of scenes\n";
      return 2;
    }
    const std::uint64_t first = std::stoull(given[0]), scenes = std::stoull(given[1]);
    judge::SetTrial trial;
    trial.starts = std::stoi(value("--starts", "10000"));
    trial.work = std::stod(value("--work", "1e6"));
    trial.phc = has("--phc");
    trial.paths = has("--paths");
    trial.couplings = has("--couplings");
    test::LinkageLoads loads;
    loads.springs = std::stoi(value("--springs", "1"));
    loads.torsion_springs = std::stoi(value("--torsion", "0"));
    loads.free_lengths = !has("--zero");
    loads.one_way = std::stod(value("--one-way", "0"));
    const std::string only = value("--kind", "");
    const bool is_mixed = has("--mixed"), is_planted = has("--planted");
    const std::vector<std::string>& families = test::scene_families();
    const bool is_scene = !is_mixed && std::find(families.begin(), families.end(), only) != families.end();
    const std::vector<std::string>& kinds = is_mixed ? test::mixed_kinds() : test::linkage_kinds();

    int complete = 0, contradicted = 0, phc = 0, lost = 0, ends = 0;
    double slowest = 0.0;
    std::uint64_t slowest_seed = first;
    for (std::uint64_t seed = first; seed < first + scenes; ++seed) {
      const std::string kind = is_planted ? "planted" : only.empty() ? kinds[seed % kinds.size()] : only;
      const Scene scene = is_planted ? judge::planted_scene(seed, trial)
                          : is_mixed ? test::mixed_mechanism(kind, seed)
                          : is_scene ? test::random_scene(only, seed)
                                     : test::random_linkage(kind, seed, loads);
      if (has("--print")) std::cout << test::scene_text(scene) << std::flush;
      const judge::JudgedSet judged = [&] {
        try {
          return judge::judge_set(scene, trial);
        } catch (const InputError& error) {  // stops that contradict each other, as some families draw them
          judge::JudgedSet none;
          none.statement = error.what();
          return none;
        }
      }();
      complete += judged.claim == Claim::complete ? 1 : 0;
      phc += judged.phc_ran ? 1 : 0;
      lost += judged.phc_lost;
      ends += judged.path_ends;
      contradicted += judged.contradictions.empty() ? 0 : 1;
      for (const std::string& c : judged.contradictions) std::cout << fmt::format("{} {}: {}\n", kind, seed, c);
      if (judged.claim == Claim::complete) {
        if (judged.seconds > slowest) {
          slowest = judged.seconds;
          slowest_seed = seed;
        }
      } else {
        std::cout << fmt::format("{} {}: {}\n", kind, seed, judged.statement);
      }
      std::cout << std::flush;
    }
    std::cout << fmt::format(
        "{} scenes: {} complete ({:.2f} %), the slowest in {:.3f} s (seed {}); {} held against PHCpack, which missed "
        "{}, {} ends of paths; {} contradicted\n",
        scenes, complete, 100.0 * complete / static_cast<double>(std::max<std::uint64_t>(scenes, 1)), slowest,
        slowest_seed, phc, lost, ends, contradicted);
    return contradicted == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "poise_equilibria: " << error.what() << '\n';
    return 2;
  }
}
