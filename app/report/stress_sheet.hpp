#pragma once

// What the reports of `poise stress`, in the terminal and for docs/, are put together from.

#include <string>
#include <vector>

#include "app/report/stress_report.hpp"

namespace poise::app {

/// What a method, or a form of virtual work, comes to over all cases.
struct MethodSummary {
  std::string name;
  int taken = 0;                                ///< cases with an answer that it does not refuse
  int mastered = 0;                             ///< of these
  int wrong = 0, denied = 0, inexact = 0;       ///< starts
  double iterations = 0.0, microseconds = 0.0;  ///< medians over cases; not a number where it never arrived
};

std::vector<MethodSummary> summaries(const StressOutcome& outcome);

/// The cases of the overview: all, or, of safeguards, those where switching one off changes the arrivals.
std::vector<const comparison::CaseResult*> shown_cases(const StressOutcome& outcome);

/// Digits that an error leaves: "9.4"; "-" where it is not known.
std::string digits_of(double allowed);

}  // namespace poise::app
