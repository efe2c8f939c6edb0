#pragma once

#include <set>

namespace poise {

/// Elements of a scene along distances, of those that push their points apart, that may have no length somewhere: their
/// force has no direction there and the energy a peak, which is no equilibrium.
struct ElementPeaks {
  static constexpr double shortest = 1e-8;  ///< mechanism sizes
  std::set<int> exactly{};                  ///< the points meet, or there is no equilibrium all the same
  std::set<int> nearly{};                   ///< or pass each other by less than `shortest`; then one is left out

  void add(const ElementPeaks& others) {
    exactly.insert(others.exactly.begin(), others.exactly.end());
    nearly.insert(others.nearly.begin(), others.nearly.end());
  }
};

}  // namespace poise
