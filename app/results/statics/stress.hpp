#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "comparison/friction_cases.hpp"
#include "comparison/stress_summary.hpp"

namespace poise::app {

/// What `poise stress --list` shows: the cases by kind.
Result stress_list_result(const std::vector<comparison::HardCase>& cases,
                          const std::vector<comparison::FrictionCase>& friction);

/// What `poise stress` shows, made by `command`: false claims, and then either the sheet of all cases (per cent of the
/// starts that converge, case by case and method by method, and a summary of each method; of safeguards only the cases
/// where one makes a difference), or, where `details` are asked for, case by case effort and errors. Cases of friction
/// have a table of their own.
Result stress_result(const comparison::StressOutcome& outcome, const std::vector<comparison::FrictionResult>& friction,
                     const std::string& command, bool details);

}  // namespace poise::app
