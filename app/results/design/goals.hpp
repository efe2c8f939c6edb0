#pragma once

#include <cstdint>
#include <string>

#include "app/result/result.hpp"
#include "design/goals/design_search.hpp"

namespace poise::app {

/// What `poise design` shows of goals: numbers found, what the goals come to with their margins, what holds back, and
/// what is proved; docs/json.md.
Result goals_result(const GoalProblem& problem, const GoalDesign& found, std::uint64_t seed, double microseconds);

/// The text of the problem's scene file with the numbers found; empty where there are none.
std::string scene_text_of(const GoalProblem& problem, const GoalDesign& found);

}  // namespace poise::app
