#pragma once

#include <string>

#include "comparison/stress_summary.hpp"

namespace poise::app {

// What `poise stress` writes. Times in microseconds, errors in rad or length over mechanism size.

/// One row for each case and method. Columns: case, kind, expect, method, why, refused (1 or 0), starts, arrived,
/// inexact, wrong, denied, iterations, microseconds, error, allowed (see comparison::Cell).
std::string stress_csv(const comparison::StressOutcome& outcome);

/// A JSON object: poise, command, interrupted, cases [{name, kind, title, source, seek, expect, why, methods [{method,
/// refused, starts, arrived, inexact, wrong, denied, iterations, microseconds, error, allowed, why}]}].
std::string stress_json(const comparison::StressOutcome& outcome, const std::string& command);

}  // namespace poise::app
