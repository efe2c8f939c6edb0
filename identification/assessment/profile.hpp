#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "identification/fit/fit.hpp"

namespace poise {

/// The profile likelihood of one parameter: how the cost grows where the parameter is held and all others are fitted
/// anew.
///
/// A value x belongs to the 95 % interval where  2 (cost(x) - cost at the fit) (e_0 / e)^2 <= q^2,  q the quantile of
/// Student's t that the fit's own interval has, e_0 the standard error of white noise as stated and e the leading one:
/// so that without curvature it is that interval, also where residuals are correlated. Source: W. Q. Meeker, L. A.
/// Escobar, Teaching about approximate confidence regions based on maximum likelihood estimation, 1995.
struct LikelihoodProfile {
  int parameter = 0;
  std::vector<double> value;   ///< shown values, SI, ascending; the fit's among them
  std::vector<double> growth;  ///< sqrt(2 (cost - cost at the fit)) e_0 / e, in standard errors, at each
  /// Ends of the interval, shown, SI. At a bound of the parameter the interval ends there, and the other end is that of
  /// a one-sided 95 % interval. Empty where the growth did not reach the limit within 20 standard errors, or no fit
  /// succeeded there.
  std::optional<double> low, high;
  bool one_sided = false;
};

struct ProfileOptions {
  int jobs = 0;  ///< threads; 0: all cores. The result does not depend on it.
  const std::atomic<bool>* interrupt = nullptr;
  std::function<void(const std::string&)> progress{};
};

/// By continuation outwards from the fit: every point starts from the last ones. The fit must be usable and the
/// parameter's standard error finite.
LikelihoodProfile profile(const FitProblem& problem, const std::vector<Record>& records, const Fit& fitted,
                          int parameter, const ProfileOptions& options = {});

/// Of several parameters, which are taken on threads; only those that were done before an interrupt.
std::vector<LikelihoodProfile> profiles(const FitProblem& problem, const std::vector<Record>& records,
                                        const Fit& fitted, const std::vector<int>& parameters,
                                        const ProfileOptions& options = {});

}  // namespace poise
