#pragma once

namespace poise {

/// A stop that is touched in equilibrium.
struct TouchedStop {
  int stop = 0;         ///< index into Scene::stops
  bool at_max = false;  ///< the limit that is touched; of equal ones that which presses
  double force = 0.0;   ///< with which it presses, N or N m; 0 of one that only touches
};

}  // namespace poise
