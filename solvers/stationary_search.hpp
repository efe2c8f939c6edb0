#pragma once

#include <vector>

#include "solvers/filter.hpp"
#include "solvers/loop_closing.hpp"
#include "solvers/newton_system.hpp"

namespace poise::solvers {

/// Newton steps on {F + J^T y = 0, c = 0} from the current point, halved until a filter accepts them. Finds any
/// stationary point; works for fields without a potential.
class StationarySearch {
 public:
  StationarySearch(NewtonSystem& system, LoopClosing& closing);

  NewtonEnd run();

 private:
  bool begin_anew();
  bool shorten(double alpha);

  NewtonSystem& at_;
  LoopClosing& closing_;
  Filter filter_;
  std::vector<double> y_before_;
};

}  // namespace poise::solvers
