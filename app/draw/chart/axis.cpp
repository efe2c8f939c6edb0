#include "app/draw/chart/axis.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace poise::app {
namespace {

// Sizes between which numbers are written without an exponent.
constexpr double smallest_plain_tick = 1e-3;
constexpr double largest_plain_tick = 1e6;
// Decades that are written out: 0.01 .. 1000.
constexpr int lowest_plain_decade = -2;
constexpr int highest_plain_decade = 3;

struct Span {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return !(low <= high); }
};

int order_of(double value) { return static_cast<int>(std::floor(std::log10(value))); }

/// The least of 1, 2, 5 times a power of ten from 0.65 `wanted` on.
double round_step(double wanted) {
  constexpr double enough = 0.65;
  const double decade = std::pow(10.0, order_of(wanted));
  for (double step : {1.0, 2.0, 5.0}) {
    if (step * decade >= enough * wanted) return step * decade;
  }
  return 10 * decade;
}

std::string superscript(int number) {
  static constexpr std::array<const char*, 10> digits = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = number < 0 ? "⁻" : "";
  for (char c : std::to_string(std::abs(number))) text += digits[static_cast<std::size_t>(c - '0')];
  return text;
}

std::string power_of_ten(int exponent) { return "10" + superscript(exponent); }

std::string decade_label(int decade) {
  if (decade < lowest_plain_decade || decade > highest_plain_decade) return power_of_ten(decade);
  return fmt::format("{:.{}f}", std::pow(10.0, decade), std::max(0, -decade));
}

}  // namespace

Axis linear_axis(const std::vector<double>& values, double margin, int marks) {
  constexpr double constant = 1e-10;
  Span span;
  for (double v : values) {
    if (std::isfinite(v)) span.include(v);
  }
  if (span.empty()) span = {0.0, 1.0};
  const double size = std::max(std::abs(span.low), std::abs(span.high));
  if (span.high - span.low <= constant * size) {
    const double around = size > 0 ? 0.1 * size : 1.0;
    span = {span.low - around, span.high + around};
  } else {
    const double wider = margin * (span.high - span.low);
    span = {span.low - wider, span.high + wider};
  }
  Axis axis{span.low, span.high, {}};
  const double step = round_step((axis.high - axis.low) / marks);
  const double largest = std::max(std::abs(axis.low), std::abs(axis.high));
  // Very large and very small numbers share one power of ten.
  const int exponent = largest >= smallest_plain_tick && largest < largest_plain_tick ? 0 : order_of(largest);
  const int decimals = std::max(0, exponent - order_of(step * (1 + 1e-9)));
  const std::string unit = exponent == 0 ? "" : "·" + power_of_ten(exponent);
  const auto last = static_cast<long long>(std::floor(axis.high / step + 1e-9));
  for (auto k = static_cast<long long>(std::ceil(axis.low / step - 1e-9)); k <= last; ++k) {
    const double at = static_cast<double>(k) * step;
    axis.ticks.push_back({at, k == 0 ? "0" : fmt::format("{:.{}f}{}", at / std::pow(10.0, exponent), decimals, unit)});
  }
  return axis;
}

Axis log_axis(const std::vector<double>& values, int marks) {
  Span decades;
  for (double v : values) {
    if (!std::isfinite(v) || v <= 0.0) continue;
    decades.include(std::floor(std::log10(v) + 1e-9));
    decades.include(std::ceil(std::log10(v) - 1e-9));
  }
  if (decades.empty()) decades = {0.0, 1.0};
  if (decades.low == decades.high) decades = {decades.low - 1, decades.high + 1};
  const int low = static_cast<int>(decades.low);
  const int high = static_cast<int>(decades.high);
  Axis axis{std::pow(10.0, low), std::pow(10.0, high), {}};
  const int step = std::max(1, static_cast<int>(std::ceil(static_cast<double>(high - low) / marks)));
  for (int decade = low; decade <= high; decade += step) {
    axis.ticks.push_back({std::pow(10.0, decade), decade_label(decade)});
  }
  return axis;
}

}  // namespace poise::app
