#pragma once

#include <string>

#include "app/forces_files.hpp"
#include "app/palette.hpp"

namespace poise::app {

/// What `poise forces` prints. One pose: drives, springs, dampers and all reactions. More poses: what drives give from
/// place to place, thinned to what a screen holds, and the largest of everything else.
std::string forces_report(const MotionModel& model, const ForcesAnswer& answer, const Palette& palette);

}  // namespace poise::app
