#pragma once

#include "statics/paths/path.hpp"

namespace poise::app_tests {

/// The von Mises toggle of datasets/ with its load varied from 0 to 60 N.
VariedScene varied_toggle();

/// Its curve of equilibria by the closed form P = 2 k (l0 - l) y / l, l = sqrt(1 + y^2), from y = 0.5 m downwards to
/// 60 N: points 0.01 m apart, all proved, a fold on each side and a snap from the first of them.
Path toggle_path(const VariedScene& varied);

}  // namespace poise::app_tests
