#pragma once

// Results as text for people. All values in the units of the scene.

#include <string>
#include <vector>

#include "app/palette.hpp"
#include "statics/answer.hpp"
#include "statics/mobility.hpp"

namespace poise::app {

/// What `poise check` prints: bodies, joints, mobility, redundant constraints, what the model keeps and drops.
std::string check_report(const StaticModel& model, const Mobility& mobility, const Palette& palette);

/// What `poise solve` prints: verdict, accuracy, coordinates, springs, reactions.
std::string solve_report(const StaticModel& model, const Answer& answer, const Palette& palette);

/// What `poise compare` prints: one line for each method, whether they agree, and the coordinates side by side.
std::string compare_report(const StaticModel& model, const std::vector<Answer>& answers, const Palette& palette);

}  // namespace poise::app
