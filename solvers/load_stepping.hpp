#pragma once

#include <vector>

#include "solvers/descent.hpp"
#include "solvers/stationary_search.hpp"

namespace poise::solvers {

/// Load stepping, when all else fails: an artificial load f = F + J^T y makes the closed start an equilibrium and is
/// reduced to zero in steps, each solved from the last; a step that fails is repeated with a smaller reduction.
class LoadStepping {
 public:
  LoadStepping(NewtonSystem& system, LoopClosing& closing, StationarySearch& stationary, Descent& descent);

  /// Runs from the start; changes nothing if that cannot be closed.
  void run();

 private:
  NewtonSystem& at_;
  LoopClosing& closing_;
  StationarySearch& stationary_;
  Descent& descent_;
  std::vector<double> reached_;
};

}  // namespace poise::solvers
