#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "solvers/problem.hpp"

namespace poise::solvers {

/// What every program that searches a Problem is told, whatever its method. Each says at its declaration what its
/// tolerance is measured against.
struct SearchOptions {
  double tolerance = 1e-12;
  int iterations = 1000;  ///< at most; evaluations for methods that count no iterations
  const std::atomic<bool>* interrupt = nullptr;
};

/// How a search ended, in its own words. Whether it is right is for others to judge.
struct SearchResult {
  bool claims_success = false;
  bool interrupted = false;
  std::string status;               ///< one sentence: "Ipopt: solved", "NLopt SLSQP: evaluation limit"
  std::vector<double> x;            ///< where it ended; finite
  std::vector<double> multipliers;  ///< one per constraint row, zero for rows that do not hold; empty where unknown
  int iterations = 0;
  int evaluations = 0;  ///< distinct points at which the problem was evaluated
};

}  // namespace poise::solvers
