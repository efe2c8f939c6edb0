#pragma once

#include <string>

#include "app/motion_files.hpp"
#include "app/palette.hpp"

namespace poise::app {

/// What `poise motion` prints: verdict, start, effort, estimated error, energy balance, and where everything that moves
/// started, ended and turned round, in the units of the scene.
std::string motion_report(const MotionModel& model, const MotionAnswer& answer, const Palette& palette);

}  // namespace poise::app
