#pragma once

#include <string>
#include <vector>

#include "app/result/result.hpp"
#include "statics/friction/held.hpp"

namespace poise::app {

/// What was asked of `poise hold`.
struct HoldView {
  bool at_rest = false;              ///< at the equilibrium without friction, not as drawn
  std::string number;                ///< that is varied; empty for none
  std::optional<HeldRange> range{};  ///< of that number
  double radius = 0.0;               ///< of the pose at rest: its distance from the equilibrium, rad or mechanism sizes
};

/// What `poise hold` shows: whether friction holds the pose x, by what margin, which joints slip first, and the range
/// of the number.
Result hold_result(const StaticModel& model, const std::vector<double>& x, const HeldPose& pose, const HoldView& view,
                   const std::vector<std::string>& settings);

/// "held as drawn, with a safety of 1.7 (proved)", "slips as drawn: ...".
std::string held_in_words(const HeldPose& pose);

/// The data of a verdict, docs/json.md.
void add_held_data(Group& group, const StaticModel& model, const HeldPose& pose);

}  // namespace poise::app
