#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "identification/fit.hpp"

namespace poise {

struct MonteCarloOptions {
  int trials = 300;
  std::uint64_t seed = 1;
  /// Every fit sets out from parameters off by up to this part of the truth, each its own way.
  double off = 0.5;
  bool use_starts = true;  ///< from those; else fits find their own starts
  int threads = 0;         ///< 0: all cores
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int)> progress{};  ///< told how many trials are done; from one thread at a time
};

/// How one parameter came out over all trials; SI.
struct TrialStatistics {
  std::string name;
  double truth = 0.0;  ///< shown value
  double unit = 1.0;
  double bound = 0.0;     ///< Cramer-Rao standard deviation at the truth
  double bias = 0.0;      ///< mean of estimate - truth
  double rmse = 0.0;      ///< root mean square of estimate - truth
  double coverage = 0.0;  ///< part of the 95 % intervals, estimate +- 1.96 deviations, that hold the truth
};

/// Simulate and fit, again and again.
struct MonteCarlo {
  int trials = 0;     ///< done
  int converged = 0;  ///< of these, by the fit's own judgement
  int arrived = 0;    ///< of these, within 6 standard deviations of the truth in every parameter
  bool interrupted = false;
  std::vector<TrialStatistics> parameters;  ///< over the converged ones
  double misfit = 0.0;                      ///< mean
  double evaluations = 0.0;                 ///< mean
  double seconds = 0.0;
};

/// Every trial adds its own noise to the ideal records of all runs. Throws InputError where a run is measured.
MonteCarlo monte_carlo(const FitProblem& problem, const MonteCarloOptions& options = {});

}  // namespace poise
