#pragma once

#include <string>

#include "app/results/motion/forces.hpp"

namespace poise::app {

/// Which contacts would have to pull, and where: `cam "lobe" would have to pull from cam = 66.5 deg on`; nothing where
/// none would.
std::string pulls_in_words(const MotionModel& model, const ForcesAnswer& answer);

/// Contacts with their least forces and the places at which they change sides, and the speeds of lift-off that were
/// asked for.
void add_contacts(Group& group, const MotionModel& model, const ForcesAnswer& answer);

}  // namespace poise::app
