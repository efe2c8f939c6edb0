#pragma once

#include <vector>

#include "solvers/newton_system.hpp"

namespace poise::solvers {

/// Brings a point to where the constraints hold, by shortest steps  d = -J^T (J J^T)^-1 c.  Inequalities join where
/// they are violated.
class LoopClosing {
 public:
  explicit LoopClosing(NewtonSystem& system);

  /// From the point at hand, and where that leads nowhere from the start displaced at random, ever farther. False
  /// where none closes; `now` is then the best.
  bool run();

  /// What becomes of inequalities that were met on the way.
  enum class Stops {
    stay,           ///< they hold from then on
    while_violated  ///< they count while they are violated only
  };
  /// Steps from the point at hand, each halved until |c| falls. Returns the largest |c| left.
  double close(Stops stops = Stops::stay);

  /// Chord steps with the factors at hand until the rows that hold at `now` hold at `trial` to `tolerance`; `trial_gap`
  /// is what they lack. False where they do not get there. Overwrites `residual`.
  bool pull_back(double tolerance);

 private:
  bool shorten(Stops stops);

  NewtonSystem& at_;
  int starts_;
  std::vector<double> best_;
};

}  // namespace poise::solvers
