#pragma once

#include <string>

namespace poise::app {

/// Whether a gnuplot can be run.
bool has_gnuplot();

/// What gnuplot writes to its standard output when it reads the script, without the user's settings. No shell is
/// involved. Throws std::runtime_error with gnuplot's message where it fails.
std::string run_gnuplot(const std::string& script);

/// A text as a gnuplot string: in single quotes, within which only a single quote is special, and with
/// ’ for that one (gnuplot's own escape for it fails at the beginning of a string).
std::string gnuplot_string(const std::string& text);

}  // namespace poise::app
