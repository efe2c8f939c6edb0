#pragma once

namespace poise::app {

/// Runs `poise` and returns its exit code: 0 solved and confirmed, 1 not found or not confirmed, 2 bad input (one line
/// on standard error).
int run(int argc, const char* const* argv);

}  // namespace poise::app
