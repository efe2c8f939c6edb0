#pragma once

// Fits of simulated records whose errors are carried into a load at which a mechanism snaps: how many of the intervals
// hold the true load. The rig is a toggle under a load below that of its fold: two bars of 0.3 m, 0.2 rad above the
// line of their pivots, press a block of 4 kg against a spring; its knee swings, and the spring's stiffness and free
// length and the damping of the block are identified from the angle of a bar.

#include <cstdint>
#include <string>

namespace poise::judge {

/// The scene "rig.toml" and the experiment on it, with its records simulated for one seed.
std::string rig_scene();
std::string rig_experiment(std::uint64_t seed);

/// One fit, and what it says of the load of the fold.
struct CarriedFit {
  std::string why;  ///< there is no interval
  double value = 0.0, low = 0.0, high = 0.0;
  double first_low = 0.0, first_high = 0.0;
  bool is_linear = true;
};
CarriedFit carried_fit(std::uint64_t seed);

/// The load of the fold of the rig as it is, from the closed form: with the bars at the angle a above the line,
/// P = 2 k (l0 - 1 + 0.6 cos a) tan a, N, the largest over a.
double true_snap_load();

}  // namespace poise::judge
