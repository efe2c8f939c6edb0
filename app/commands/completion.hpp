#pragma once

// Completion of the command line in shells.

#include <string>
#include <vector>

#include "app/commands/commands.hpp"

namespace poise::app {

/// The shells that a script is made for.
std::vector<std::string> completed_shells();

/// What a shell reads so that it completes `poise`, made of these commands and their options. Throws InputError unless
/// it is one of those shells.
std::string completion_script(const std::string& shell, const std::vector<CommandEntry>& commands);

}  // namespace poise::app
