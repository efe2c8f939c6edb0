#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "identification/prediction/fit_problem.hpp"

namespace poise {

/// Residuals e against the noise that the fit weighs them by, of one sensor in one run or in all:
///   ratio^2 = sum e^2 / (n - tr H R),   ratio^2 degrees ~ chi^2(degrees),   degrees = (n - tr H R) / spread
/// where the noise is as stated, with n readings, H what the fit takes of them, R the autocorrelation and spread as of
/// solvers::Autoregression; of white residuals tr H R is the number of values estimated from them, and spread 1. Of
/// robust fits the ratio is that of the median |e| to the one of normal noise, of as many degrees as that is worth.
struct NoiseTest {
  double ratio = 0.0;    ///< NaN without readings
  double degrees = 0.0;  ///< independent residuals that they are worth
  double offset = 0.0;   ///< sum e over its standard deviation with this autocorrelation
  double size = 0.0;     ///< root mean square of e, of robust fits that of the median; NaN without readings

  /// Half the width of the interval in which 95 % of the ratios are where the noise is as stated: 1.96 / sqrt(2
  /// degrees).
  double reach() const;
  /// The size that noise as stated, with this correlation, would have: size / ratio.
  double expected() const { return size / ratio; }
  /// Of a ratio at least so far from 1, to either side, where the noise is as stated.
  double chance() const;
};

/// Standard errors of a fit under three assumptions about its residuals e. With the estimates' covariance V for white
/// noise of unit standard deviation and A = d e/d parameters, nuisances eliminated, an estimate's error is V A^T e.
///   white:  e independent:  V A^T A V
///   serial: e of each sensor a stationary autoregressive series:  V A^T R A V  with its autocorrelation R
///   runs:   only runs independent:  V sum_r (A_r^T f_r)(A_r^T f_r)^T V,  f_r = (1 - A_r V A_r^T)^(-1/2) e_r
/// each times the square of the residuals' size over the noise where that is above 1, or the noise is estimated.
/// Sources: W. K. Newey, K. D. West, 1987, for the second; R. M. Bell, D. F. McCaffrey, Bias reduction in standard
/// errors for linear regression with multi-stage samples, 2002, for the third and its degrees of freedom.
struct StandardErrors {
  enum class Kind { white, serial, runs };
  Kind leading = Kind::white;  ///< the one that the residuals allow
  std::string why;             ///< why that one, one sentence; with what limits it
  bool runs_scatter = false;   ///< by more than the errors by residuals explain, by chance once in 1000 fits
  double independent = 0.0;    ///< residuals that the series of a run is worth, the fewest
  std::vector<double> white, serial, runs;  ///< per parameter, SI; NaN where there is none
  std::vector<double> runs_degrees;         ///< degrees of freedom of the third, per parameter
  double readings_degrees = 0.0;            ///< of the others: independent residuals that all readings are worth
  std::vector<double> error;                ///< the leading one; of `runs` the larger of that and `serial`
  /// Of the estimates, SI: the leading standard errors, correlated as by `white` or, where that does not lead,
  /// `serial`.
  Eigen::MatrixXd covariance;
  /// Covariance of the estimates by white or, where that does not lead, by serial, and a root of the one by runs: that
  /// is its product with its transpose. SI.
  Eigen::MatrixXd by_readings, by_runs;
  std::vector<double> reach;  ///< half the width of the 95 % interval, Student's t
  /// Per run, per parameter: by how much an estimate changes without that run, SI; NaN where the run alone determines
  /// it. To first order; in a Fit of the runs that examine_runs() examines by a fit without them.
  std::vector<std::vector<double>> without_run;
  /// Per run: the largest of these over its standard deviation where all runs agree.
  std::vector<double> disagreement;
  std::vector<NoiseTest> sensors;                  ///< over all runs
  std::vector<std::vector<NoiseTest>> runs_noise;  ///< per run, per sensor; ratio NaN without readings

  /// The leading one of  sum gradient_i parameter_i,  by the same rule as for single parameters; SI.
  double of(const Eigen::VectorXd& gradient) const;
};

/// A run with a larger disagreement is named: among 100 runs with 5 parameters one does so by chance once in 60 fits.
inline constexpr double disagrees_from = 4.5;

std::string to_string(StandardErrors::Kind kind);

/// `covariance`: V, SI (see Identifiability::covariance). `runs`: linearized at the fit, of all runs.
StandardErrors standard_errors(const FitProblem& problem, const Eigen::MatrixXd& covariance,
                               const std::vector<LinearRun>& runs, const Weighting& weighting);

}  // namespace poise
