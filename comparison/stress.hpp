#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "comparison/catalogue.hpp"

namespace poise::comparison {

struct StressOptions {
  std::vector<Method> methods;  ///< in the order shown; all when empty
  int starts = 0;               ///< per case; the case's own number when 0
  double seconds = 1.0;  ///< a method stops trying further starts of a case after so long; virtual work never does
  solvers::Safeguards safeguards{};  ///< of virtual work
  bool scaling = true;               ///< of coordinates and equations; off: SI as it stands
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string& doing)> progress;  ///< told before every cell; may be empty
};

/// One method on one case.
struct Cell {
  Method method{};
  bool refused = false;  ///< the method cannot take the case; `why` says so
  int starts = 0;        ///< tried
  int arrived = 0;  ///< confirmed by the check, of the kind sought, and known (or, in open lists, met by 50 digits)
  int wrong = 0;    ///< confirmed by the check and yet no equilibrium, or of another stability: must be 0
  int denied = 0;   ///< claimed by the solver and denied by the check
  double iterations = 0.0;    ///< median over arrivals
  double microseconds = 0.0;  ///< median over arrivals
  double error = 0.0;         ///< largest over arrivals from the known equilibrium, rad or mechanism sizes
  double allowed = 0.0;       ///< what the condition of that equilibrium lets rounding do, same units
  std::string why;            ///< of the first start that did not arrive
};

struct CaseResult {
  HardCase hard;
  std::vector<Cell> cells;
};

/// Runs methods over cases from the same seeded starts.
std::vector<CaseResult> stress(const std::vector<HardCase>& cases, const StressOptions& options);

}  // namespace poise::comparison
