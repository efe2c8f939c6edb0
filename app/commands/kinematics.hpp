#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise kinematics SCENE --drive crank=0..360`: positions, velocities and accelerations over a driven range, and the
/// singular poses in it. Exit code solved where the whole range could be driven.
Command kinematics_command();

}  // namespace poise::app
