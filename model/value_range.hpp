#pragma once

#include <charconv>
#include <cmath>
#include <string>

namespace poise {

/// The values that a number of a scene may take; infinity and nan are never among them.
enum class Range { finite, not_negative, positive };

inline bool contains(Range range, double value) {
  if (!std::isfinite(value)) return false;
  return range == Range::finite || value > 0.0 || (range == Range::not_negative && value == 0.0);
}

/// Message about a value outside the range: "expected a finite number >= 0, found -1".
inline std::string out_of_range(Range range, double value) {
  const char* const limit = range == Range::positive ? " > 0" : range == Range::not_negative ? " >= 0" : "";
  char digits[32];
  char* const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  return std::string("expected a finite number") + limit + ", found " + std::string(digits, end);
}

}  // namespace poise
