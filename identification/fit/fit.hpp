#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "identification/fit/outliers.hpp"
#include "identification/fit/standard_errors.hpp"
#include "identification/identifiability/identifiability.hpp"
#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// The estimate of one parameter.
struct Estimate {
  std::string name;
  double value = 0.0;              ///< shown: value in the scene + includes, SI
  double standard_error = 0.0;     ///< SI; the leading one of StandardErrors
  double low = 0.0, high = 0.0;    ///< 95 % interval of the shown value, SI
  bool is_curved = false;          ///< interval and standard error are those of profile likelihoods: Fit::traces
  double truth = 0.0;              ///< shown value of the scene as written
  double unit = 1.0;               ///< SI value of the unit it is written in
  bool withheld = false;           ///< not identifiable from these data, or at a bound: the value is no measurement
  bool poorly_determined = false;  ///< its standard error is above a third of its scale (FitProblem::scale_of)
  bool at_bound = false;           ///< of its range: withheld, but a model of later runs has it there
  std::string why;                 ///< reason for withholding it

  /// Whether its 95 % interval contains 0.
  bool may_be_zero() const { return low <= 0 && high >= 0; }
};

/// Residuals and nuisances of one run as fitted.
struct RunFit {
  std::string name;
  std::vector<double> nuisances;  ///< see RunModel
  std::vector<double> rms;        ///< per sensor: root mean square residual, SI; NaN without readings
  /// Per sensor, at a lag of one sample (see autocorrelation()); near 0 for white residuals, NaN without readings.
  std::vector<double> autocorrelation;
  std::vector<double> mean;  ///< per sensor: mean residual, read - fitted, SI; NaN without readings
  /// Per sensor: whether the residuals are no independent noise, by the correlation of neighbours, and whether they are
  /// off on one side, by more than that correlation explains. Each happens by chance in at most one of 1000 fits.
  std::vector<bool> correlated, shifted;

  bool is_white() const { return std::find(correlated.begin(), correlated.end(), true) == correlated.end(); }
  bool is_shifted() const { return std::find(shifted.begin(), shifted.end(), true) != shifted.end(); }
};

enum class FitStatus {
  not_run,
  converged,  ///< and the residuals are as large as the stated noise
  misfit,     ///< converged, but they are not, of a sensor or in a run: as by chance in one of 1000 fits (NoiseTest)
  ambiguous,  ///< several minima explain the readings equally well: Fit::alternatives
  failed,     ///< no minimum was reached
  interrupted
};

std::string to_string(FitStatus status);

struct Fit;

enum class Checks {
  none,
  bounded,  ///< as far as they take a fifth of the evaluations of the fit itself, or compute few numbers
  all
};

struct FitOptions {
  bool use_starts = false;       ///< start from the experiment's starts even where start_from_oscillations() applies
  std::vector<double> starts{};  ///< in place of the experiment's: values in the scene, SI, one per parameter
  int retries = 3;               ///< further starts that are tried where the residuals indicate a local minimum
  double function_tolerance = 1e-7;  ///< ends where the sum of squares falls by less than this part of it
  /// Starts from the values and the noise of this fit of the same problem, without a search.
  const Fit* from = nullptr;
  /// Goes on from what this fit of the same unknowns has reached: its parameters, its runs' nuisances where it has
  /// them, and its noise of sensors whose noise is not stated. What it leads to is examined as any other minimum.
  const Fit* continued = nullptr;
  /// How far curvature, minima elsewhere and fits without a run put the minimum in question.
  Checks checks = Checks::bounded;
  std::vector<std::pair<int, double>> held{};  ///< parameters that keep these values in the scene, SI; with `from`
  bool values_only = false;   ///< with `from`: of the result only cost, parameters, nuisances and status are needed
  bool holds_starts = false;  ///< the nuisances are kept too, where all parameters are
  int jobs = 0;  ///< threads that the runs are computed on; 0: all cores. The result does not depend on it.
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> progress{};
};

/// The cost where one parameter was held away from its estimate and all others were fitted anew: see Curvature.
struct CostTrace {
  int held = 0;                            ///< the parameter
  double slow_low = 1.0, slow_high = 1.0;  ///< growth of the parabola over that of the cost, at the two ends
  bool open_low = false;                   ///< the cost does not grow to the limit of the interval on this side
  bool open_high = false;
};

/// One of several minima that the readings do not distinguish.
struct Alternative {
  std::vector<double> values;     ///< shown values, SI, one for each of Fit::estimates
  std::vector<double> frequency;  ///< Hz, ascending: natural frequencies of the first run
  double more = 0.0;              ///< sum of squared residuals over the noise, less that of the best minimum
};

struct Fit {
  FitStatus status = FitStatus::not_run;
  std::string why;
  std::string start;               ///< how the initial parameters were found
  double cost = 0.0;               ///< half the sum of rho over all residuals and priors
  std::vector<double> parameters;  ///< values in the scene, SI
  std::vector<Estimate> estimates;
  std::vector<Alternative> alternatives;  ///< the best minimum first; empty unless ambiguous
  std::vector<RunFit> runs;
  Identifiability identifiability;
  /// sqrt(sum of (residual / noise)^2 / degrees of freedom): 1 where the stated noise explains the residuals.
  double residual_over_noise = 0.0;
  /// Its standard deviation about 1 for normal noise with the residuals' autocorrelation: sqrt(1 / (2 degrees)) of one
  /// sensor (see NoiseTest).
  double residual_over_noise_sigma = 0.0;
  Weighting weighting;            ///< with the noise of every sensor, estimated where it is not known
  StandardErrors errors;          ///< empty where they are not known
  std::vector<CostTrace> traces;  ///< where the cost is no parabola
  std::vector<Outlier> outliers;
  std::vector<double> rms;  ///< per sensor over all runs, SI
  int readings = 0;
  int degrees_of_freedom = 0;  ///< readings less the parameters and nuisances that are not held
  int iterations = 0;
  int evaluations = 0;        ///< of all runs, with their sensitivities
  int check_evaluations = 0;  ///< the same to put the minimum in question; with those without sensitivities
  int tries = 0;
  double microseconds = 0.0;
  /// What has not put the minimum in question although it should have, because of FitOptions::checks; in words.
  std::vector<std::string> unexamined;

  bool usable() const { return status == FitStatus::converged || status == FitStatus::misfit; }
};

/// Finds the parameters by Ceres (Levenberg-Marquardt within the ranges) with Jacobians from the variational equations.
///
/// It starts from start_from_oscillations() where that applies; else from the experiment's starts, over windows that
/// grow to the whole records. Where the residuals exceed the noise, other starts are tried and the best result is kept:
/// start_from_regression(), the starts changed at random, then with all frequencies scaled by factors from 1/4 to 4.
///
/// Where the times of the readings hardly distinguish the frequencies found from others between a quarter of and four
/// times those found and those at the start, the parameters with these others are starts as well. Minima whose sums of
/// squares differ by less than 16, over the noise, are equally good: the fit is ambiguous, its estimates are withheld.
/// The same holds of minima from twins(): there only the estimates that differ are withheld.
/// (Noise takes the wrong one of two minima for the better one by more than 16 in at most 1 of 30 000 fits.)
Fit fit(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options = {});

/// Keeps Ceres' own warnings off standard error, for the whole program: the result of a fit states what failed.
void quiet_ceres();

}  // namespace poise
