#pragma once

#include <limits>

namespace poise {

/// Stands for a number that is not known.
inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

}  // namespace poise
