#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "identification/assessment/bootstrap.hpp"
#include "identification/assessment/known_numbers.hpp"
#include "identification/assessment/misfit.hpp"
#include "identification/assessment/profile.hpp"
#include "identification/assessment/record_faults.hpp"
#include "identification/fit/fit.hpp"

namespace poise {

struct IdentifyOptions {
  FitOptions fit{};                     ///< its jobs, interrupt and progress are those of all steps
  std::vector<std::string> profiles{};  ///< parameters, or unknowns, whose profile likelihoods are found
  int bootstrap = 0;                    ///< samples of a bootstrap of the residuals; 0: none
};

/// What the readings of an experiment say: a fit, and all that puts its standard errors in question.
struct Identification {
  std::vector<Record> records;  ///< that were fitted
  Fit fit;                      ///< with the effects of known numbers and inputs in its standard errors
  /// Per sensor, SI: rms_from_first_readings() of measured runs; empty where not computed.
  std::vector<double> rms_from_readings;
  std::vector<KnownEffect> known;           ///< of the experiment's known numbers
  std::vector<KnownEffect> inputs;          ///< input_effects()
  std::vector<LikelihoodProfile> profiles;  ///< of those asked for whose standard errors are finite
  std::optional<Bootstrap> bootstrap;
  std::vector<RecordFault> faults;  ///< record_faults()
  std::optional<GrossMisfit> misfit;
  std::vector<MisfitCause> causes;  ///< of it, or of a fit that failed; not sought where records are wrong
  /// Nor without checks (Checks::none), or to the end where that was interrupted.
  enum class Sought { yes, no, interrupted } sought = Sought::no;

  /// Whether some readings are no measurements.
  bool has_wrong_records() const {
    return std::any_of(faults.begin(), faults.end(), [](const RecordFault& fault) { return fault.is_wrong; });
  }
  /// Whether the estimates are those of the mechanism as far as the records can show: the fit is usable, no gross
  /// misfit, and of records that are not wrong.
  bool is_believable() const { return fit.usable() && !misfit && !has_wrong_records(); }

  /// Finds the estimate of this name, "k" or "k (low)". Throws InputError with the nearest name where there is none, or
  /// the fit has no estimates.
  const Estimate& estimate(const std::string& name) const;
};

/// Estimates the unknowns of an experiment from its records, or from simulated ones. Throws InputError for profiles of
/// names that no unknown has, and std::runtime_error where a simulated run fails. That a fit fails is no exception:
/// Fit::status.
Identification identify(const FitProblem& problem, const IdentifyOptions& options = {});

/// Estimates them after check_spans() and expect_no_markers(). Throws InputError where these do.
Identification identify(const Experiment& experiment, const IdentifyOptions& options = {});

/// Finds the parameter of this name, or all values of the unknown of this name. Throws InputError with the nearest name
/// where there is none.
std::vector<int> parameters_named(const FitProblem& problem, const std::string& name);

}  // namespace poise
