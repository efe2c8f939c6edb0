#pragma once

// What the reports of `poise stress`, in the terminal and for docs/, are put together from.

#include <optional>
#include <string>
#include <vector>

#include "app/report/stress_report.hpp"

namespace poise::app {

/// What a method, or a form of virtual work, comes to over all cases.
struct MethodSummary {
  std::string name;
  int taken = 0;                                   ///< cases with an answer that it does not refuse
  int mastered = 0;                                ///< of these
  int wrong = 0, denied = 0, inexact = 0;          ///< starts
  std::optional<double> iterations, microseconds;  ///< medians over cases; empty where it never arrived
};

std::vector<MethodSummary> summaries(const StressOutcome& outcome);

/// The cases of the overview: all, or, of safeguards, those where switching one off changes the arrivals.
std::vector<const comparison::CaseResult*> shown_cases(const StressOutcome& outcome);

/// Digits that an error leaves: "9.4"; "-" where it is not known.
std::string digits_of(const std::optional<double>& allowed);

}  // namespace poise::app
