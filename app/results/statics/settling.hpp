#pragma once

#include "app/result/result.hpp"
#include "statics/equilibrium/equilibrium.hpp"

namespace poise::app {

/// How an equilibrium is related to the start: lines of text for a content, and warnings where it is in doubt. Nothing
/// where it was not settled.
void show_settling(Result& result, const StaticModel& model, const Equilibrium& equilibrium);

/// What the settling cost: "12 evaluations, 30 µs".
void show_settling_effort(Group& group, const Equilibrium& equilibrium);

/// The same as data: `settled`, null where it was not settled.
void add_settling_data(Group& group, const StaticModel& model, const Equilibrium& equilibrium);

}  // namespace poise::app
