#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "model/scene.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::test {

/// A mechanism for designs, driven, loaded or at rest: SI, its numbers as drawn.
Scene mechanism_for_design(std::uint64_t seed);

/// Goals that numbers of a mechanism are known to meet.
struct PlantedGoals {
  std::string what;    ///< of messages
  std::string scene;   ///< the text of the mechanism as it was drawn
  std::string design;  ///< the design file, which names "scene.toml"
  Scene planted;       ///< meets all goals
  Scene start;         ///< the same with other numbers within their ranges
  int numbers = 0, goals = 0;
};

/// One to six numbers of a random mechanism are forgotten, and values that it had, at single positions or over a
/// range, are goals. Nothing where the mechanism has no single regular curve over the range.
std::optional<PlantedGoals> plant_goals(std::uint64_t seed);

/// Writes scene.toml and design.toml into the folder; returns the path of the design.
std::string write_files(const app_tests::TempFolder& folder, const PlantedGoals& problem);

}  // namespace poise::test
