#pragma once

namespace poise {

/// Derivatives of a closure by rad and mechanism sizes that are not larger are rounding of its lengths, as of a pin
/// that was written twice: the closure says nothing.
inline constexpr double rounding_of_closures = 1e-15;

}  // namespace poise
