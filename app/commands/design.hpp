#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise design FILE`: dimensions that meet the goals of a design file, found from random starts and judged by the
/// general kinematics. Exit code solved where all goals are met and that confirms it.
Command design_command();

}  // namespace poise::app
