#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// Standard errors by refitting records that are made from the residuals of a fit.
struct Bootstrap {
  int samples = 0;     ///< fits that converged
  int failed = 0;      ///< fits that did not
  double block = 0.0;  ///< length of a block, s; infinite: whole runs
  /// Per parameter, SI; empty where an interrupt left less than `least_samples`.
  std::vector<double> standard_error;
  std::vector<double> low, high;  ///< per parameter: percentiles 2.5 and 97.5 of the shown value, SI; likewise
  bool interrupted = false;
  static constexpr int least_samples = 20;  ///< that percentiles are taken of
};

struct BootstrapOptions {
  int samples = 0;
  std::uint64_t seed = 1;
  int jobs = 0;  ///< threads; 0: all cores. The result does not depend on it.
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(int)> progress{};  ///< called with the samples done
};

/// The moving-block bootstrap of residuals: every run's prediction plus blocks of residuals, all sensors of a run at
/// the same times, drawn with replacement from the runs; times sqrt(readings / (readings - values estimated)). Blocks
/// are as long as the residuals of 20 independent readings, at most a run: then whole runs are drawn, each with a
/// random sign. Readings at rest are independent: each is given the residual of one of them. Source: H. R. Kunsch, The
/// jackknife and the bootstrap for general stationary observations, 1989. The fit must be usable.
Bootstrap bootstrap(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                    const BootstrapOptions& options);

}  // namespace poise
