#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise modes SCENE`: natural frequencies, shapes and damping of the small motions about an equilibrium. Exit code
/// solved where the equilibrium is confirmed and its motions are known.
Command modes_command();

}  // namespace poise::app
