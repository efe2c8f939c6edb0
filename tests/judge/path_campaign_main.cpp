// poise_path_campaign: load paths of random mechanisms against other ways to the same answers.
//
//   poise_path_campaign [first seed] [number of scenes] [random starts of each]
//
// Prints the paths that end before their range, that carry unproved points or that shorter steps change, and a summary.

#include <cstdint>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tests/judge/path_campaign.hpp"

int main(int count, char** words) {
  const std::vector<std::string> given(words + 1, words + count);
  const auto number = [&](std::size_t k, std::uint64_t otherwise) {
    return k < given.size() ? std::stoull(given[k]) : otherwise;
  };
  const std::uint64_t first = number(0, 1), scenes = number(1, 100);
  const int starts = static_cast<int>(number(2, 0));
  int traced = 0, retraced = 0, points = 0, unproved = 0, connected = 0, elsewhere = 0;
  for (std::uint64_t seed = first; seed < first + scenes; ++seed) {
    const auto judged = poise::judge::judge_path(seed, seed % 4 == 3, seed % 4 == 1, starts);
    traced += judged.traced;
    retraced += judged.retraced;
    points += judged.points;
    unproved += judged.unproved;
    connected += judged.connected;
    elsewhere += judged.elsewhere;
    if (!judged.ended.empty()) std::cout << seed << " ends: " << judged.ended << '\n';
    if (judged.unproved > 0) std::cout << seed << " unproved points: " << judged.unproved << '\n';
    if (!judged.retraced) std::cout << seed << " shorter steps: " << judged.differences << '\n';
  }
  std::cout << fmt::format(
      "{} paths, {} traced to their ends, {} the same with shorter steps; {} points, {} unproved; at the last value {} "
      "equilibria on the paths, {} others from {} starts each\n",
      scenes, traced, retraced, points, unproved, connected, elsewhere, starts);
  return 0;
}
