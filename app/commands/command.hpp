#pragma once

#include <functional>

#include <CLI/CLI.hpp>

#include "app/palette.hpp"

namespace poise::app {

/// A command of `poise`: its part of the command line, and what to do once that has been read. run() prints its report
/// on standard output in the palette, writes the files asked for and returns the exit code; bad input is thrown as
/// InputError.
struct Command {
  CLI::App* app;
  std::function<int(const Palette&)> run;
};

}  // namespace poise::app
