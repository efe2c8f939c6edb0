#pragma once

#include "app/commands/command.hpp"

namespace poise::app {

/// `poise check SCENE`: what the scene is: bodies, joints, mobility, what the model keeps. bad_input where it cannot be
/// assembled.
Command check_command();

}  // namespace poise::app
