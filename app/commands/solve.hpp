#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise solve SCENE`: where it rests, by one method.
Command solve_command();

}  // namespace poise::app
