#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/palette.hpp"
#include "comparison/stress_summary.hpp"

namespace poise::app {

/// "nearest", "stable", "locked" or "none": what a case asks for.
std::string asked_for(const comparison::HardCase& hard);

/// What stands in a cell of the overview: the per cent of starts that arrived, cut to tenths, so that only all are
/// "100" and only none are "0"; "-" where the method refuses; with "!" behind where something was wrongly claimed.
std::string arrival(const comparison::Cell& cell);

/// Digits that an error leaves: "9.4"; "-" where it is not known.
std::string digits_of(const std::optional<double>& allowed);

/// The cases under their headings.
std::string stress_list(const std::vector<comparison::HardCase>& cases, const Palette& palette);

/// All cases on one sheet: arrivals case by case and method by method, what each method comes to, and why some cases
/// have no answer. Of safeguards only the cases where one makes a difference.
std::string stress_overview(const comparison::StressOutcome& outcome, const Palette& palette);

/// The same case by case, with effort and errors.
std::string stress_details(const comparison::StressOutcome& outcome, const Palette& palette);

/// The overview as a page for docs/, made by that command.
std::string stress_markdown(const comparison::StressOutcome& outcome, const std::string& command);

}  // namespace poise::app
