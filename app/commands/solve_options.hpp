#pragma once

#include <string>

#include "app/commands/command.hpp"
#include "app/commands/commands.hpp"

namespace poise::app {

/// What solve and compare take: a scene, --seek (its word goes to `seek`), --json and --svg. Both must outlive the
/// command.
void add_solve_options(Command& command, Request& request, std::string& seek);

/// nearest or stable. Throws InputError.
Seek read_seek(const std::string& word);

}  // namespace poise::app
