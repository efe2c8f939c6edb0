#pragma once

#include <string>

#include "motion/kinematics.hpp"

namespace poise::app {

/// Reads "crank=0..360", or "crank=30" for one place, in the scene's units. Throws InputError naming --drive.
DriveRange read_drive(const std::string& text, const Scene& scene);

}  // namespace poise::app
