#pragma once

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "comparison/stress.hpp"

namespace poise::app {

/// What `poise stress` has run.
struct StressOutcome {
  std::string command;               ///< as it was asked for: "poise stress --starts 100"
  std::vector<std::string> methods;  ///< names of the cells of every case: methods, or forms of virtual work
  bool safeguards = false;           ///< they are forms of virtual work
  double seconds = 1.0;              ///< StressOptions::seconds
  std::size_t asked = 0;             ///< cases
  std::vector<comparison::CaseResult> results;
  bool interrupted = false;  ///< cut off before every cell was done
};

/// "nearest", "stable", "locked" or "none": what a case asks for.
std::string asked_for(const comparison::HardCase& hard);

/// What stands in a cell of the overview: the per cent of starts that arrived, cut to tenths, so that only all are
/// "100" and only none are "0"; "-" where the method refuses; with "!" behind where something was wrongly claimed.
std::string arrival(const comparison::Cell& cell);

/// The cases under their headings.
std::string stress_list(const std::vector<comparison::HardCase>& cases, const Palette& palette);

/// All cases on one sheet: arrivals case by case and method by method, what each method comes to, and why some cases
/// have no answer. Of safeguards only the cases where one makes a difference.
std::string stress_overview(const StressOutcome& outcome, const Palette& palette);

/// The same case by case, with effort and errors.
std::string stress_details(const StressOutcome& outcome, const Palette& palette);

/// The overview as a page for docs/.
std::string stress_markdown(const StressOutcome& outcome);

/// What was wrongly claimed, and what virtual work (with all its safeguards) fails to master although there is an
/// answer.
struct StressFailures {
  int wrong = 0;                    ///< claims
  std::vector<std::string> missed;  ///< cases
};
StressFailures failures_of(const StressOutcome& outcome);

}  // namespace poise::app
