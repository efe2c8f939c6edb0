#pragma once

#include <string_view>

namespace poise::app {

/// Puts something in the place of standard streams that were closed, so that no file takes their number and what is
/// meant for them: of standard output what is always full, so that a report that nobody gets is noticed.
void hold_standard_streams();

/// Writes to standard error. Where that is closed or full nobody can be told, and the exit code alone speaks.
void say(std::string_view text);

}  // namespace poise::app
