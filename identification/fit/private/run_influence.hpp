#pragma once

#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// Replaces StandardErrors::without_run and ::disagreement, which are of first order about a minimum to which a run
/// that is off has moved the fit and its errors, by those of fits without the run: for the runs that change the
/// estimates by more than 3 times what they should to first order; and, where the residuals are larger than the noise,
/// or the errors follow from them, for those that change them most.
///
/// With the estimates p of the other runs, their covariance V for white noise of unit size and A = d e/d parameters of
/// the run, the estimates of all runs differ from p, where it agrees, by a part
///   diag(V A^T (1 + A V A^T)^-1 A V) / diag V
/// of the variance of p. That variance is what the other runs' residuals say: of their series, or from run to run where
/// that is more, both as far as Student's t of so many says it.
///
/// Nothing changes with fewer than three runs. `linear`: all runs at the fit. Ends where all checks of the fit have
/// taken `most` evaluations, which the fit says then.
void examine_runs(const FitProblem& problem, const std::vector<Record>& records, const std::vector<LinearRun>& linear,
                  const FitOptions& options, int most, Fit& fitted);

}  // namespace poise
