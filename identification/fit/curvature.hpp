#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// Where the cost C near a fit is no parabola, so that standard errors, which follow from its second derivatives at the
/// minimum, do not say how far the readings leave the parameters free.
///
/// Along the directions d_k of the covariance's axes, one standard error long, the weakest first, the cost is computed
/// at x + 2 d_k, the nuisances following linearly, where the parabola grows by 2: the growth
///   g = sqrt(2 (C - C(x))) / 2
/// in parts of that is 1 on a parabola. Where it is not, the parameter that d_k changes most, relative to the scales,
/// is held at values away from x and all others are fitted anew: the trace x(s) of its profile likelihood, with the
/// growth q(s) in standard errors. With c_j the standard error of another parameter j where that one is known, the 95 %
/// region along the trace reaches for j over all
///   x_j(s) +- c_j sqrt(t^2 - q(s)^2),   q(s) <= t,
/// t the quantile of its interval: on a parabola this is its interval itself. The same is done from nulls of which a
/// dimension is part, and along which the cost does change at finite steps.
/// Source: D. M. Bates, D. G. Watts, Nonlinear regression analysis and its applications, 1988, ch. 6 (profile traces).
struct Curvature {
  std::vector<CostTrace> traces;
  /// Per parameter: its interval along all traces, values in the scene, SI; NaN without traces.
  std::vector<double> low, high;
  /// Per parameter: how much more slowly than the parabola the cost grows on a side on which the interval does not end;
  /// 0 where it ends.
  std::vector<double> open;
  int evaluations = 0;        ///< of all runs
  bool is_complete = true;    ///< false where that took all evaluations that there were
  std::optional<Fit> better;  ///< a point with a lower cost was found: the fit had not reached the minimum
};

/// Finds the curvature of a usable fit with its standard errors. `linear` are the runs linearized there. The search
/// ends after `most` evaluations with what was found until then.
Curvature find_curvature(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                         const std::vector<LinearRun>& linear, const FitOptions& options,
                         int most = std::numeric_limits<int>::max());

}  // namespace poise
