#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "identification/fit/fit.hpp"
#include "studies/study.hpp"

namespace poise {

struct MonteCarloOptions {
  int trials = 300;
  std::uint64_t seed = 1;
  /// Every fit starts from parameters that differ from the truth by up to this part of it, drawn at random.
  double start_error = 0.5;
  bool use_starts = true;  ///< from these; else fits find their own starts
  studies::StudyOptions study{};
  /// What the trials depend on besides these options: of what is kept in StudyOptions::folder, and between ranks.
  std::vector<std::pair<std::string, std::string>> identity{};
};

/// The estimates of one parameter over all trials; SI.
struct TrialStatistics {
  std::string name;
  double truth = 0.0;  ///< shown value
  double unit = 1.0;
  double bound = 0.0;     ///< Cramer-Rao bound of the standard error, at the truth
  double bias = 0.0;      ///< mean of estimate - truth
  double rmse = 0.0;      ///< root mean square of estimate - truth
  double coverage = 0.0;  ///< part of the 95 % intervals, estimate +- 1.96 standard errors, that cover the truth

  /// The bound is finite.
  bool is_identifiable() const;
};

/// A statistic of n trials, with its own standard error and what theory expects.
struct Statistic {
  double value = 0.0, standard_error = 0.0, expected = 0.0;
  /// Within 4 standard errors of what is expected.
  bool as_expected() const;
};

/// An estimator that is unbiased and reaches the Cramer-Rao bound, with correct intervals, has
///   bias / bound 0 +- 1/sqrt(n),   rmse / bound 1 +- 1/sqrt(2 n),   coverage 0.95 +- sqrt(0.95 0.05 / n).
struct BoundStatistics {
  Statistic bias, rmse, coverage;
  bool as_expected() const { return bias.as_expected() && rmse.as_expected() && coverage.as_expected(); }
};

/// Of an identifiable parameter over `trials` converged trials.
BoundStatistics against_bound(const TrialStatistics& parameter, int trials);

/// Many trials, each simulated with its own noise and fitted.
struct MonteCarlo {
  int asked = 0;       ///< trials of this shard
  int trials = 0;      ///< done
  int computed = 0;    ///< of these, now; the others were read from StudyOptions::folder
  int converged = 0;   ///< of these, with FitStatus::converged
  int near_truth = 0;  ///< of these, within 6 standard errors of the truth in every parameter
  bool interrupted = false;
  std::vector<TrialStatistics> parameters;  ///< over the converged ones
  /// The same of the combinations that are identifiable where parameters are not, those that hold for any change along
  /// the nulls; at the truth, SI.
  std::vector<Identifiability::Combination> combined;
  std::vector<TrialStatistics> combinations;
  double residual_over_noise = 0.0;  ///< mean
  double evaluations = 0.0;          ///< mean
  double seconds = 0.0;
  std::vector<std::string> warnings;  ///< of damaged files
};

/// Adds noise to the ideal records of all runs and fits them, trial by trial. The random numbers of a trial depend on
/// the seed and the trial alone, and statistics are summed in the order of the trials: the result does not depend on
/// threads, ranks and interruptions. Throws InputError where a run is measured, and as studies::run_study().
MonteCarlo monte_carlo(const FitProblem& problem, const MonteCarloOptions& options = {});

}  // namespace poise
