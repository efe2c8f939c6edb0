#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise compare SCENE`: where it rests, by virtual work and by energy side by side; exit code solved where every one
/// that does not refuse the scene is confirmed. With --methods by any of them; exit code solved where one is confirmed.
/// With --tolerances: what accuracy costs each method; exit code solved where some run is confirmed.
Command compare_command();

}  // namespace poise::app
