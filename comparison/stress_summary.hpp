#pragma once

// What a run of the catalogue comes to.

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
  double seconds = 1.0;              ///< StressOptions::seconds
  std::size_t asked = 0;             ///< cases
  std::vector<CaseResult> results;
  bool interrupted = false;  ///< before every cell was done
};

/// One method, or one form of virtual work, over all cases.
struct MethodSummary {
  std::string name;
  int taken = 0;                                   ///< cases with an answer to which it applies
  int mastered = 0;                                ///< of these
  int wrong = 0, denied = 0, inexact = 0;          ///< starts
  std::optional<double> iterations, microseconds;  ///< medians over cases; empty where it never arrived
};

std::vector<MethodSummary> summaries(const StressOutcome& outcome);

/// The cases worth showing side by side: all, or, of safeguards, those where switching one off changes the arrivals by
/// a tenth of a per cent or makes a claim wrong.
std::vector<const CaseResult*> shown_cases(const StressOutcome& outcome);

/// The part of starts that arrived in tenths of a per cent, cut, so that only all are 1000 and only none are 0; empty
/// where there were no starts.
std::optional<int> arrived_tenths(const Cell& cell);

/// What was wrongly claimed, and what virtual work (with all its safeguards) fails to master although there is an
/// answer.
struct StressFailures {
  int wrong = 0;                    ///< claims
  std::vector<std::string> missed;  ///< cases
};
StressFailures failures_of(const StressOutcome& outcome);

}  // namespace poise::comparison
