#pragma once

#include <functional>
#include <vector>

namespace poise::benchmarks {

/// Solves the given number of times in sequence; returns seconds per solution.
using Turn = std::function<double(int times)>;

struct RaceLength {
  double seconds = 2.5;  ///< new turns begin until this time
  int fewest_turns = 5;
};

/// Median seconds per solution of each. Turns and their order alternate, so that changes of the machine's speed affect
/// all alike. Solutions shorter than half a millisecond run several times per turn.
std::vector<double> race(const std::vector<Turn>& turns, const RaceLength& length = {});

}  // namespace poise::benchmarks
