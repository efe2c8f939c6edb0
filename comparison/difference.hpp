#pragma once

#include <cstddef>
#include <vector>

#include "statics/static_model.hpp"

namespace poise::comparison {

/// How far two poses of one mechanism are apart.
struct Difference {
  double size = 0.0;           ///< largest difference of a scaled coordinate: rad, or length over mechanism size
  std::size_t coordinate = 0;  ///< the coordinate of that difference
  bool whole_turns = false;    ///< some angle differs by whole turns, which are not counted
};

/// Whether poses a whole turn of a body apart are different: where a spring or a stop upon an angle counts turns. A
/// constant torque does not.
bool turns_count(const Scene& scene);

/// The difference of two sets of scaled coordinates. Angles count without whole turns unless turns_count().
Difference largest_difference(const StaticModel& model, const std::vector<double>& a, const std::vector<double>& b);

}  // namespace poise::comparison
