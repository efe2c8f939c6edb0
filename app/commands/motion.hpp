#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise motion SCENE --duration S`: the free or driven motion of a scene, with its energy balance and estimated
/// error. Exit code solved where the motion came to its end and both confirm it; Ctrl-C keeps what was reached.
Command motion_command();

}  // namespace poise::app
