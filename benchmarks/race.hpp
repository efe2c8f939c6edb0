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

/// Median seconds per solution of each contender, over turns that alternate, as does who begins, so that a change of
/// the machine's mood meets all. What takes less than half a millisecond runs several times per turn.
std::vector<double> race(const std::vector<Turn>& contenders, const RaceLength& length = {});

}  // namespace poise::benchmarks
