#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise compare SCENE`: where it rests, by all methods side by side. Exit code solved where every method that does
/// not refuse the scene is confirmed.
Command add_compare(CLI::App& app);

}  // namespace poise::app
