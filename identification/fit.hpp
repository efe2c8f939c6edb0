#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "identification/fit_problem.hpp"
#include "identification/identifiability.hpp"

namespace poise {

/// One parameter as found.
struct Estimate {
  std::string name;
  double value = 0.0;      ///< shown: value in the scene + includes, SI
  double deviation = 0.0;  ///< standard deviation, SI; already enlarged by Fit::misfit where that is above 1
  double truth = 0.0;      ///< shown value of the scene as written
  double unit = 1.0;       ///< SI value of the unit it is written in
  bool withheld = false;   ///< not told by the data, or on a bound: not to be taken for a measurement
  std::string why;         ///< it is withheld
};

/// How one run came out.
struct RunFit {
  std::string name;
  std::vector<double> nuisances;        ///< see RunModel
  std::vector<double> rms;              ///< per sensor: root mean square residual, SI
  std::vector<double> autocorrelation;  ///< per sensor: of residuals one sample apart; near 0 for white ones
  bool white = true;                    ///< all |autocorrelation| < 4 / sqrt(samples)
};

enum class FitStatus {
  not_run,
  converged,  ///< and the residuals are as large as the noise says
  misfit,     ///< converged, but the residuals are larger than the noise explains: the model misses something
  failed,     ///< no minimum was reached
  interrupted
};

std::string to_string(FitStatus status);

struct FitOptions {
  bool use_starts = false;           ///< set out from the experiment's starts even where swings would tell better ones
  std::vector<double> starts{};      ///< in place of the experiment's: values in the scene, SI, one per parameter
  int retries = 3;                   ///< other starts that are tried where the residuals speak of a local minimum
  double function_tolerance = 1e-7;  ///< ends where the sum of squares falls by less than this part of it
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> progress{};
};

struct Fit {
  FitStatus status = FitStatus::not_run;
  std::string why;
  std::string start;               ///< how the start was found, one sentence
  std::vector<double> parameters;  ///< values in the scene, SI
  std::vector<Estimate> estimates;
  std::vector<RunFit> runs;
  Identifiability identifiability;
  double misfit =
      0.0;  ///< sqrt(sum of squared residuals / noise over degrees of freedom): 1 where the noise explains all
  double expected = 0.0;  ///< its own standard deviation around 1
  /// How many times larger deviations are where residuals one sample apart have the correlation r that was found,
  /// sqrt((1 + r) / (1 - r)) for a first-order process: 1 for white residuals. Deviations do not contain it.
  double colour = 1.0;
  std::vector<double> rms;  ///< per sensor over all runs, SI
  int readings = 0;
  int degrees = 0;  ///< of freedom
  int iterations = 0;
  int evaluations = 0;  ///< of all runs, with their sensitivities
  int tries = 0;
  double microseconds = 0.0;

  bool usable() const { return status == FitStatus::converged || status == FitStatus::misfit; }
};

/// Finds the parameters by Ceres (Levenberg-Marquardt within the ranges) with Jacobians from the variational equations.
///
/// Where start_from_swings() can tell a start it is used; else windows that grow over the records lead from the
/// experiment's starts to the whole. What comes out is judged by its residuals: where they are larger than the noise
/// says, other starts are tried and the best answer kept.
Fit fit(const FitProblem& problem, const std::vector<Record>& records, const FitOptions& options = {});

/// Keeps Ceres' own warnings off standard error, for the whole program: a fit tells in its result what went wrong.
void quiet_ceres();

}  // namespace poise
