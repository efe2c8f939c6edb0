#pragma once

// Comparison of a program's output with the output that a page shows.

#include <string>
#include <vector>

namespace poise::docs_tests {

/// Why a line is not the expected one; empty where it is. Words must be equal, runs of blanks count as one. Numbers may
/// differ by 1e-6 of their size or by three units of the last printed decimal; two numbers below 1e-9 are both
/// rounding. Durations in ns, µs or ms, those in s on a line that begins with "effort" or "method", and the program's
/// version are not compared.
std::string difference(const std::string& expected, const std::string& printed);

/// The same for a whole output. An expected line "..." stands for any lines, also for none.
std::string difference(const std::vector<std::string>& expected, const std::vector<std::string>& printed);

/// The printed output with the cuts of the expected one: each "..." again stands between the lines most like those
/// that surrounded it.
std::vector<std::string> cut_like(const std::vector<std::string>& expected, const std::vector<std::string>& printed);

}  // namespace poise::docs_tests
