#pragma once

#include <atomic>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// One of several models of the same readings.
struct ModelFit {
  Fit fit;
  double cost = 0.0;  ///< half the sum of rho at the noise that all models are compared with
  /// Akaike's and Schwarz' criteria less those of the best model,  2 cost / (s^2 l) + 2 parameters  and
  /// ... + log(readings / l) parameters,  s^2 the mean square of the best residuals over the noise where that is above
  /// 1, l the mean of (leading error / white error)^2 in the model of the least cost.
  double aic = 0.0, bic = 0.0;
  /// Per run: root mean square of the run's residuals over the noise, of the fit to all runs, and of a fit to the runs
  /// of other folds, where only the run's own start and equilibrium are fitted to it. NaN where that fit failed, or
  /// the run has a parameter of its own.
  std::vector<double> own, held_out;
  double held_out_all = std::numeric_limits<double>::quiet_NaN();  ///< root mean square of the latter over all
                                                                   ///< readings; NaN where a run has none
};

/// A model against one that contains it.
struct NestedTest {
  std::size_t simple = 0, full = 0;  ///< indices of the models
  int added = 0;                     ///< parameters
  double ratio = 0.0;  ///< 2 (cost of simple - cost of full) / (s^2 l), s^2 the mean square of the full model's
                       ///< residuals where that is above 1, l the mean of (leading error / white error)^2 of the
                       ///< parameters added: chi squared with `added` degrees of freedom if the simple one holds
  double p = 1.0;      ///< probability of a larger one; half of it where one parameter is added at its bound
  double f = 0.0;      ///< ratio / added, against F with the residuals' independent number less parameters
  double f_p = 1.0;
};

struct ModelComparison {
  std::vector<ModelFit> models;
  std::vector<NestedTest> tests;
  /// Least error on runs held out; where that is equal or there is none, least Akaike's criterion. Errors are equal
  /// within sqrt(eps) of themselves, eps = FitOptions::function_tolerance, criteria within max(1e-3, 2 cost eps /
  /// (s^2 l)): so far from their minima fits may end.
  std::size_t preferred = 0;
  /// All models of which that is so, the preferred one included, where there are several: these explain the readings
  /// equally well.
  std::vector<std::size_t> equally_good;
  int folds = 0;  ///< 0: no runs were held out
  /// Per model: mean over the runs of (squared held-out error less the preferred model's), and its standard error.
  std::vector<double> loss, loss_error;
  bool interrupted = false;
};

struct CompareOptions {
  FitOptions fit{};
};

/// Leaves out of all experiments the readings of measured runs that one of them leaves out for its delays
/// (compared_times()), so that models of one record can be compared. Leaves alone what does not correspond.
void leave_out_alike(const std::vector<Experiment*>& experiments);

/// Fits all models to the same records, one per run, and compares them. `problems` must have the same runs and sensors,
/// and outlive nothing. Sources: K. P. Burnham, D. R. Anderson, Model Selection and Multimodel Inference, ch. 2
/// (criteria under overdispersion); A. Rotnitzky, N. P. Jewell, Hypothesis testing of regression parameters in
/// semiparametric generalized linear models for cluster correlated data, 1990 (tests under correlation); M. Stone, 1974
/// (cross-validation). Throws InputError where the readings of two models differ.
ModelComparison compare_models(const std::vector<const FitProblem*>& problems, const CompareOptions& options = {});

}  // namespace poise
