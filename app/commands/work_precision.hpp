#pragma once

#include <string>
#include <vector>

#include "app/commands/commands.hpp"
#include "app/palette.hpp"
#include "comparison/work_precision.hpp"

namespace poise::app {

/// "1e-2..1e-14": from the first by decades as far as the second; or a list "1e-3,1e-6", which is put in falling order,
/// each value once. Throws InputError where that is no range of falling numbers within 1e-20 <= tolerance < 1.
std::vector<double> read_tolerances(const std::string& text);

/// The part of `poise compare` that measures work against precision: runs, writes the files of the request and prints
/// the report. Returns solved where some run is confirmed, and nothing interrupted it.
int run_work_precision(const Request& request, comparison::WorkPrecisionOptions options, const Palette& palette);

}  // namespace poise::app
