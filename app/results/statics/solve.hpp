#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/friction/held.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// What `poise solve` shows: verdict, positions, spring forces, joint forces, stops, what was left out, numerics.
/// With the verdict on the assembled pose where the scene has friction, and the quantities asked for at an equilibrium.
/// `seeks_stable` says where a reader of this result finds an equilibrium in which the mechanism stays.
Result solve_result(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings,
                    const HeldPose* as_drawn = nullptr, const std::vector<SoughtQuantity>& show = {},
                    const std::string& seeks_stable = "--seek stable searches for one in which it stays");

/// The data of an answer: method, seek, status, ..., see docs/json.md; what was not reached is null.
void add_answer_data(Group& group, const StaticModel& model, const Answer& answer);

/// "unstable", "of unknown stability", ...
std::string kind_of(const Answer& answer);

Tone tone_of(Status status);

}  // namespace poise::app
