#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "model/scene.hpp"

namespace poise::test {

/// What one goal of a design file comes to in a scene.
struct JudgedGoal {
  bool holds = false;
  double margin = 0.0;  ///< to the nearest limit, over the size of the goal; 0 of goals without limits
  std::string why;      ///< one sentence, where it does not hold
};

/// Judges each [[goal]] of a design file in a scene: by paths on a grid of 181 values, settled equilibria and
/// sensitivities, with the extremes of the grid. Nothing of design/ takes part; aims hold where they have values. What
/// a limit may be missed by is 1e-7 of the size of the goal.
std::vector<JudgedGoal> judge_goals(const std::filesystem::path& design, const Scene& scene);

/// The goals that do not hold, with their reasons; empty where all hold.
std::string missed_goals(const std::filesystem::path& design, const Scene& scene);

}  // namespace poise::test
