#pragma once

// Summaries of a run of the catalogue.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "comparison/stress.hpp"

namespace poise::comparison {

/// A run of stress() or stress_safeguards().
struct StressOutcome {
  std::vector<std::string> methods;  ///< names of the cells of every case: methods, or forms of virtual work
  bool safeguards = false;           ///< they are forms of virtual work
  double work = 2e5;                 ///< StressOptions::work
  std::optional<double> seconds{};   ///< StressOptions::seconds
  std::size_t asked = 0;             ///< cases
  std::vector<CaseResult> results;
  bool interrupted = false;  ///< before every cell was done
};

/// One method, or one form of virtual work, over all cases.
struct MethodSummary {
  std::string name;
  int applicable = 0;                              ///< cases with an answer to which it applies
  int solved = 0;                                  ///< of these
  int false_claims = 0, denied_by_check = 0;       ///< starts
  std::optional<double> iterations, microseconds;  ///< medians over cases; empty where it never converged
};

std::vector<MethodSummary> summaries(const StressOutcome& outcome);

/// The cases worth showing side by side: all, or, of safeguards, those where switching one off changes the share of
/// starts that converge by a tenth of a per cent, or makes a false claim.
std::vector<const CaseResult*> shown_cases(const StressOutcome& outcome);

/// The share of starts that converged, in tenths of a per cent, cut, so that only all are 1000 and only none are 0;
/// empty where there were no starts.
std::optional<int> converged_tenths(const Cell& cell);

/// False claims, and the cases with an answer that virtual work (with all its safeguards) does not solve.
struct StressFailures {
  int false_claims = 0;
  std::vector<std::string> unsolved;  ///< cases
};
StressFailures failures_of(const StressOutcome& outcome);

}  // namespace poise::comparison
