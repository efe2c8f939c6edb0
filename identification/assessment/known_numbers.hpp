#pragma once

#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// What the uncertainty of one number that is taken as known does to the estimates.
struct KnownEffect {
  std::string name;            ///< of the number, with the label where its errors are independent per label
  std::vector<double> change;  ///< of every parameter for one standard deviation of the number, SI
};

/// Propagates the uncertainty of the experiment's known numbers to the estimates, to first order: with the error d of a
/// number in all runs of its group, the estimates change by  -V sum_r A_r^T (d e_r/d number) d,  V and A as of
/// StandardErrors. The changes of different numbers are independent. Source: the "consider" covariance of S. F.
/// Schmidt, Application of state-space methods to navigation problems, 1966.
/// Throws std::runtime_error where a motion fails at the fit.
std::vector<KnownEffect> known_effects(const FitProblem& problem, const Fit& fitted,
                                       const std::vector<Record>& records);

/// Adds the effects to the standard errors and intervals of the estimates.
void add_known_effects(const std::vector<KnownEffect>& effects, Fit& fitted);

}  // namespace poise
