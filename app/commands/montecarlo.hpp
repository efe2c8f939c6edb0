#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise montecarlo EXPERIMENT`: simulate and fit, again and again, with new noise and new starts. Ctrl-C keeps the
/// trials that have ended. Exit code solved where all trials ended and fits converged.
Command montecarlo_command();

}  // namespace poise::app
