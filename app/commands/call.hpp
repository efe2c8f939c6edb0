#pragma once

#include <string>
#include <utility>
#include <vector>

#include "app/commands/caller.hpp"

namespace poise::app {

/// An option as the command line has it, "--seed" or "SCENE", with the word given to it; of a flag the word is left
/// out.
using GivenOption = std::pair<std::string, std::string>;

/// The command line with these options, as a shell reads it.
std::string line_of(const std::string& command, const std::vector<GivenOption>& options);

/// Runs a command of `poise` for a program, as the command line would with these options in their order, and leaves in
/// the caller's outcome what it found. Where a mechanism cannot be assembled the verdict says so. Nothing is printed;
/// files are written that options name. Throws InputError for bad input, with the line that `poise` prints.
void call(const std::string& command, const std::vector<GivenOption>& options, Caller& caller);

}  // namespace poise::app
