#pragma once

#include <functional>
#include <vector>

namespace poise::benchmarks {

/// Solves so many times, one after the other; seconds per solution.
using Turn = std::function<double(int times)>;

struct RaceLength {
  double seconds = 2.5;  ///< turns begin until this time is over
  int fewest_turns = 5;
};

/// Median seconds per solution of each. Turns alternate, and so does which begins, so that a machine that changes its
/// speed does so for all. What takes less than half a millisecond runs several times per turn.
std::vector<double> race(const std::vector<Turn>& turns, const RaceLength& length = {});

}  // namespace poise::benchmarks
