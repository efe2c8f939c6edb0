#include "benchmarks/race.hpp"

#include <algorithm>
#include <chrono>

#include "benchmarks/timing.hpp"

namespace poise::benchmarks {
namespace {

constexpr double shortest_turn = 5e-4;  // seconds

int solutions_per_turn(const Turn& turn) {
  if (turn(1) > shortest_turn) return 1;  // and caches are warm
  return std::max(1, static_cast<int>(shortest_turn / turn(1)));
}

}  // namespace

std::vector<double> race(const std::vector<Turn>& turns, const RaceLength& length) {
  const std::size_t count = turns.size();
  std::vector<int> times;
  for (const Turn& turn : turns) times.push_back(solutions_per_turn(turn));
  std::vector<std::vector<double>> seconds(count);
  const auto begin = std::chrono::steady_clock::now();
  const auto time_left = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() < length.seconds;
  };
  for (int round = 0; round < length.fewest_turns || time_left(); ++round) {
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t next = round % 2 == 0 ? k : count - 1 - k;
      seconds[next].push_back(turns[next](times[next]));
    }
  }
  std::vector<double> medians;
  for (const std::vector<double>& of_one : seconds) medians.push_back(median(of_one));
  return medians;
}

}  // namespace poise::benchmarks
