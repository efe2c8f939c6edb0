#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "model/toml_text.hpp"

namespace poise::app {

/// A number without digits that mean nothing: to a multiple of `grain`, which is a power of ten.
inline std::string rounded(double value, double grain) {
  constexpr double longest = 1e15;
  if (std::abs(value) >= longest) return toml_number(value);
  const int digits = std::clamp(static_cast<int>(std::lround(-std::log10(grain))), 0, 15);
  const double scale = std::pow(10.0, digits);
  double near = std::round(value * scale) / scale;
  if (near == 0.0) near = 0.0;  // not -0
  std::string out = fmt::format("{:.{}f}", near, digits);
  if (digits > 0) {
    out.erase(out.find_last_not_of('0') + 1);
    if (out.back() == '.') out.pop_back();
  }
  return out;
}

}  // namespace poise::app
