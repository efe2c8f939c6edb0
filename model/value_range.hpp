#pragma once

#include <charconv>
#include <cmath>
#include <string>

namespace poise {

/// The values that a number of a scene may take: zero, or in SI units 1e-50 to 1e50 in magnitude, so that products and
/// quotients of several numbers neither over- nor underflow. Infinity and nan are never among them.
enum class Range { finite, not_negative, positive };

inline constexpr double largest_value = 1e50;

/// Whether the range contains a value in SI units.
inline bool contains(Range range, double value) {
  if (value == 0.0) return range != Range::positive;
  if (value < 0.0 && range != Range::finite) return false;
  return std::abs(value) <= largest_value && std::abs(value) >= 1.0 / largest_value;
}

/// Message about a value outside the range, as it is written: "expected a finite number >= 0, found -1".
inline std::string out_of_range(Range range, double written) {
  const char* const limit = range == Range::positive ? " > 0" : range == Range::not_negative ? " >= 0" : "";
  const bool sized = std::isfinite(written) && (written > 0.0 || (range == Range::finite && written != 0.0));
  const char* const size = !sized                     ? ""
                           : std::abs(written) > 1.0  ? " of at most 1e50 in SI units"
                           : range == Range::positive ? " of at least 1e-50 in SI units"
                                                      : " of at least 1e-50 in SI units, or 0";
  char digits[32];
  char* const end = std::to_chars(digits, digits + sizeof digits, written).ptr;
  return std::string("expected a finite number") + limit + size + ", found " + std::string(digits, end);
}

}  // namespace poise
