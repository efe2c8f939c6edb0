#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise identifiability EXPERIMENT`: what it can tell, before any data. Exit code solved where that could be judged.
Command identifiability_command();

}  // namespace poise::app
