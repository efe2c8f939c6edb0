#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "identification/experiment/experiment_text.hpp"
#include "identification/identifiability/identifiability.hpp"

namespace poise {

/// A result that runs are to make sharp.
struct PlannedPrediction {
  std::string name;            ///< "fold.load.P"
  std::string unit_name;       ///< of the scene that it is a result of
  double value = 0.0;          ///< at the experiment's own values, in that unit
  Eigen::VectorXd by;          ///< its derivatives by the parameters of the experiment, SI, per that unit
  Eigen::VectorXd rounding{};  ///< of these
};
/// That of a quantity at the settled equilibrium of a scene, which has the experiment's values. Throws InputError where
/// the scene lacks a number that is to be identified, where that has a value for each label, or where there are no
/// derivatives.
PlannedPrediction planned_prediction(const FitProblem& problem, Scene scene, const std::string& quantity);

struct PlanOptions {
  /// The criterion, in place of that of the limits: the variance c^T M^-1 c of this result.
  std::optional<PlannedPrediction> prediction{};
  std::uint64_t seed = 1;  ///< of the candidates and of the starts of the exchange
  int jobs = 0;            ///< threads; 0: all cores
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> progress{};  ///< what is being done; by one thread at a time
};

/// What some runs determine, at the scene's own values.
struct PlanStep {
  bool ok = false;
  std::string why;
  /// Per parameter of the experiment, SI: its Cramer-Rao bound; infinite where it is not identifiable.
  std::vector<double> standard_error;
  /// The largest standard error over the parameter's value, or over its scale where the experiment gives one.
  double worst = std::numeric_limits<double>::infinity();
  double prediction = 0.0;  ///< standard error of PlanOptions::prediction, in its unit; infinite where it is not known
  std::vector<double> singular_values;  ///< of all A_r and priors together, descending, see Plan
  std::vector<Identifiability::Direction> not_identifiable;
  std::vector<std::string> without_run;  ///< parameters of labels that no run has
};

/// Runs to make.
///
/// With A_r the readings of run r over their noise, differentiated by the parameters over their scales and freed from
/// the run's nuisances, the information of some runs is  M = sum A_r^T A_r + priors  and their covariance M^-1. Of a
/// set of candidates that fills the limits, runs are added one by one and then exchanged (Fedorov) as long as that
/// improves the criterion, from several starts; NLopt then moves all numbers of the runs within their ranges. M is
/// computed in the pose and for the numbers of the scene, so that a plan is as good as these.
struct Plan {
  std::vector<PlannedRun> runs;  ///< each the one that improves the criterion most after those before it
  bool interrupted = false;      ///< then these are the best found so far
  std::string why;               ///< where there are none
  PlanStep own;                  ///< all runs of the experiment as it is
  std::vector<PlanStep> steps;   ///< after 1, 2, ... of the runs, together with those that have been measured
  std::size_t candidates = 0;    ///< runs that were tried
  std::size_t skipped = 0;       ///< of these, those that cannot be made or whose motion fails
  std::string skipped_because;   ///< of the first
  std::size_t evaluations = 0;   ///< motions with sensitivities
  int templates = 1;
};

/// `own` is of the experiment that `text` was made of. Does not depend on the number of threads.
Plan plan_runs(const FitProblem& own, const ExperimentText& text, const PlanOptions& options = {});

}  // namespace poise
