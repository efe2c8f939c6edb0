#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise forces SCENE`: what drives must give and joints carry in a pose, over a driven range, or along a recorded
/// motion. Exit code solved where every body is in balance everywhere.
Command forces_command();

}  // namespace poise::app
