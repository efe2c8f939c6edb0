#pragma once

#include <vector>

#include "solvers/newton_system.hpp"

namespace poise::solvers {

/// Moves a point onto the constraints by minimum-norm steps  d = -J^T (J J^T)^-1 c.  Violated inequalities become
/// active.
class LoopClosing {
 public:
  explicit LoopClosing(NewtonSystem& system);

  /// From `now`, and if that fails from the start displaced at random by growing distances. False if none closes; `now`
  /// is then the point with the smallest gap.
  bool run();

  /// How inequalities that were reached on the way are treated.
  enum class Stops {
    stay,           ///< they stay active
    while_violated  ///< they are active only while they are violated
  };
  /// Steps from `now`, each halved until |c| decreases. Returns the largest |c| left.
  double close(Stops stops = Stops::stay);

  /// Chord steps with the current factors until the rows active at `now` hold at `trial` to `tolerance`; `trial_gap` is
  /// their residual. False if they do not converge. Overwrites `residual`.
  bool pull_back(double tolerance);

 private:
  bool shorten(Stops stops);

  NewtonSystem& at_;
  int starts_;
  std::vector<double> best_;
};

}  // namespace poise::solvers
