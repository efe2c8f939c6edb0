#pragma once

#include <vector>

#include "solvers/descent.hpp"
#include "solvers/stationary_search.hpp"

namespace poise::solvers {

/// After a failed run: further runs from its start displaced at random by growing distances and closed, until one
/// converges.
class Restarts {
 public:
  Restarts(NewtonSystem& system, LoopClosing& closing, StationarySearch& stationary, Descent& descent);

  /// By descent, else by the stationary search.
  void run(bool by_descent);

 private:
  NewtonSystem& at_;
  LoopClosing& closing_;
  StationarySearch& stationary_;
  Descent& descent_;
  std::vector<double> displaced_;
};

}  // namespace poise::solvers
