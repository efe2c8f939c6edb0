#pragma once

#include <vector>

#include "app/draw/figure.hpp"
#include "design/goals/design_search.hpp"

namespace poise::app {

/// The mechanism before and after, side by side where the first sweep begins, or at rest; as found, along that sweep,
/// with its charts; and the charts of the other sweeps. Nothing where no numbers were found.
std::vector<Figure> goals_figures(const GoalProblem& problem, const GoalDesign& found);

}  // namespace poise::app
