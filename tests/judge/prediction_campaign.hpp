#pragma once

// Fits of simulated swings of a toggle (tests/support/toggle_rig.hpp) whose errors are carried into the load at which
// it snaps: how many of the intervals hold the true load.

#include <cstdint>
#include <string>

namespace poise::judge {

/// One fit, and what it says of the load of the fold.
struct CarriedFit {
  std::string why;  ///< there is no interval
  double value = 0.0, low = 0.0, high = 0.0;
  double first_low = 0.0, first_high = 0.0;
  bool is_linear = true;
};
CarriedFit carried_fit(std::uint64_t seed);

}  // namespace poise::judge
