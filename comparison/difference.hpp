#pragma once

#include <cstddef>
#include <vector>

#include "statics/model/static_model.hpp"

namespace poise::comparison {

/// Difference of two poses of one mechanism.
struct Difference {
  double size = 0.0;           ///< largest difference of a scaled coordinate: rad, or length over mechanism size
  std::size_t coordinate = 0;  ///< the coordinate of that difference
  bool whole_turns = false;    ///< some angle also differs by whole turns, which are not counted
};

/// Whether poses that differ by a whole turn of a body count as different: if a spring or a stop acts on an angle. A
/// constant torque does not count turns.
bool turns_count(const Scene& scene);

/// The difference of two sets of scaled coordinates. Angles are compared without whole turns unless turns_count().
Difference largest_difference(const StaticModel& model, const std::vector<double>& a, const std::vector<double>& b);

}  // namespace poise::comparison
