#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// Options common to all programs that search a Problem. The declaration of each says which quantity its tolerance
/// bounds.
struct SearchOptions {
  double tolerance = 1e-12;
  int iterations = 1000;  ///< at most; evaluations for methods that count no iterations
  const std::atomic<bool>* interrupt = nullptr;
};

/// How a search ended by its own report, which is not checked here.
struct SearchResult {
  bool claims_success = false;
  bool interrupted = false;
  std::string status;               ///< one sentence: "Ipopt: solved", "NLopt SLSQP: evaluation limit"
  std::vector<double> x;            ///< the last point; finite
  std::vector<double> multipliers;  ///< one per constraint row, zero for inactive rows; empty if unknown
  int iterations = 0;
  int evaluations = 0;  ///< distinct points at which the problem was evaluated
};

}  // namespace poise::solvers
