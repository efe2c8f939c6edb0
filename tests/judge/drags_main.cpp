// poise_drags: equilibria followed through random drags and changes, against small steps and fresh certificates.
//
//   poise_drags FIRST COUNT [--scenes FILE...] [--catalogue FOLDER] [--steps N] [--print] [--undecided]
//
// Without files: the random mechanisms of the seeds FIRST ... (scene_to_drag). With files, and with the cases of a
// catalogue: each scene with each of the seeds. What is no scene, or has more than 60 bodies, is left out. --print:
// every step. Prints what is contradicted, with the seed and step, and a summary; times are those of the processor.
// Ends with 1 where a position is wrong: a flip, no equilibrium, or another fault than those of how it moves.

#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "comparison/catalogue.hpp"
#include "model/input_error.hpp"
#include "tests/judge/drag_campaign.hpp"

namespace {

using poise::judge::Fault;
using poise::judge::JudgedDrags;

constexpr std::size_t most_bodies = 60;

struct Summary {
  int runs = 0, none = 0, steps = 0, confirmed = 0, errors = 0, judged = 0, undecided = 0, contradicted = 0;
  std::array<int, 6> kinds{};
  std::map<Fault, int> faults;
  std::map<std::pair<int, std::string>, std::vector<JudgedDrags::Time>> times;

  void add(const std::string& name, const JudgedDrags& run, bool print) {
    ++runs;
    steps += run.steps;
    confirmed += run.confirmed;
    errors += run.errors;
    judged += run.judged;
    undecided += static_cast<int>(run.undecided.size());
    contradicted += static_cast<int>(run.contradictions.size());
    for (std::size_t k = 0; k < kinds.size(); ++k) kinds[k] += run.kinds[k];
    const int upto = run.bodies <= 3 ? 3 : run.bodies <= 6 ? 6 : run.bodies <= 10 ? 10 : run.bodies <= 20 ? 20 : 60;
    for (JudgedDrags::Time time : run.times) {
      time.words = name + ": " + time.words;
      const std::string what = time.jumps           ? "snap or settle"
                               : time.action == 'd' ? "drag"
                               : time.action == 'c' ? "change"
                                                    : "other";
      times[{upto, what}].push_back(std::move(time));
    }
    for (const JudgedDrags::Contradiction& c : run.contradictions) {
      ++faults[c.fault];
      std::cout << fmt::format("{}: CONTRADICTED: {}: {}\n", name, to_string(c.fault), c.words);
    }
    if (print) {
      for (const std::string& u : run.undecided) std::cout << name << ": undecided: " << u << '\n';
    }
    std::cout << std::flush;
  }

  void print() {
    std::cout << fmt::format(
        "{} runs ({} scenes could not begin), {} steps: none {}, followed {}, snapped {}, settled {}, blocked {}, "
        "refused {}, input errors {}; {} confirmed; {} ways judged by small steps, {} undecided; {} contradicted\n",
        runs, none, steps, kinds[0], kinds[1], kinds[2], kinds[3], kinds[4], kinds[5], errors, confirmed, judged,
        undecided, contradicted);
    for (const auto& [fault, count] : faults) std::cout << fmt::format("{}: {}\n", to_string(fault), count);
    for (auto& [key, all] : times) {
      std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
      const auto part = [&all = all](double p) {
        return 1e3 * all[static_cast<std::size_t>(p * static_cast<double>(all.size() - 1))].seconds;
      };
      std::cout << fmt::format(
          "up to {:2} bodies, {:14}: {:6}, median {:.3f} ms, 99 % {:.3f} ms, worst {:.2f} ms ({})\n", key.first,
          key.second, all.size(), part(0.5), part(0.99), part(1.0), all.back().words);
    }
  }
};

}  // namespace

int main(int count, char** words) {
  using namespace poise;
  try {
    const std::vector<std::string> given(words + 1, words + count);
    if (given.size() < 2) {
      std::cerr << "poise_drags: expected the first seed and a number of seeds\n";
      return 2;
    }
    const std::uint64_t first = std::stoull(given[0]), seeds = std::stoull(given[1]);
    judge::DragTrial trial;
    bool tell = false;
    std::vector<std::pair<std::string, Scene>> scenes;
    const auto add = [&](const std::string& name, const auto& read) {
      try {
        Scene scene = read();
        if (scene.bodies.size() <= most_bodies + 1) scenes.emplace_back(name, std::move(scene));
      } catch (const InputError&) {
      }
    };
    bool from_files = false;
    for (std::size_t k = 2; k < given.size(); ++k) {
      if (given[k] == "--steps") {
        trial.steps = std::stoi(given.at(++k));
      } else if (given[k] == "--print") {
        trial.print = true;
      } else if (given[k] == "--undecided") {
        tell = true;
      } else if (given[k] == "--catalogue") {
        from_files = true;
        for (const comparison::HardCase& hard : comparison::read_catalogue(given.at(++k))) {
          if (!hard.scene.empty()) add(hard.name, [&] { return comparison::scene_of(hard); });
        }
      } else if (given[k] == "--scenes") {
        from_files = true;
      } else {
        add(given[k], [&] { return read_scene(given[k]); });
      }
    }
    Summary summary;
    for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
      const auto run = [&](const std::string& name, const Scene& scene) {
        try {
          summary.add(name, judge::judge_drags(scene, seed, trial), tell);
        } catch (const InputError&) {  // nothing that can move, say, or loops that cannot be closed
          ++summary.none;
        }
      };
      if (from_files) {
        for (const auto& [name, scene] : scenes) run(fmt::format("{} seed {}", name, seed), scene);
        continue;
      }
      std::string kind;
      try {
        const Scene scene = judge::scene_to_drag(seed, kind);
        run(fmt::format("{} {}", kind, seed), scene);
      } catch (const InputError&) {
        ++summary.none;
      }
    }
    summary.print();
    const bool is_wrong = summary.faults.contains(Fault::flip) || summary.faults.contains(Fault::unconfirmed) ||
                          summary.faults.contains(Fault::other);
    return is_wrong ? 1 : 0;
  } catch (const std::exception& error) {
    std::cerr << "poise_drags: " << error.what() << '\n';
    return 2;
  }
}
