#pragma once

#include <string>
#include <vector>

#include "app/commands/caller.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/quantities/quantity.hpp"

namespace poise::app {

/// The scene at a time, s. Throws InputError naming --time where that is not finite, or where no load depends on it.
Scene scene_at_time(Scene scene, double time);

/// What `poise solve` shows of an answer.
struct SolveOutcome {
  Result result;
  Pictures pictures;  ///< those asked for, where there is a position to draw
  bool is_solved = false;
};
SolveOutcome outcome_of(const StaticModel& model, const Answer& answer, const std::vector<std::string>& settings,
                        const std::vector<SoughtQuantity>& show, bool wants_svg, bool wants_figures);

}  // namespace poise::app
