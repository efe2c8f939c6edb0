#pragma once

#include <vector>

#include "solvers/descent.hpp"
#include "solvers/stationary_search.hpp"

namespace poise::solvers {

/// The last resort: the closed start is held in balance by the artificial load f = F + J^T y that it lacks, and that
/// load is let go by steps, each solved from the last; a step that gives up goes back and lets go of less.
class LoadStepping {
 public:
  LoadStepping(NewtonSystem& system, LoopClosing& closing, StationarySearch& stationary, Descent& descent);

  /// From the start; changes nothing where that cannot be closed.
  void run();

 private:
  NewtonSystem& at_;
  LoopClosing& closing_;
  StationarySearch& stationary_;
  Descent& descent_;
  std::vector<double> reached_;
};

}  // namespace poise::solvers
