#include "app/result/numbers.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace poise::app {
namespace {

// Beyond these, numbers are written with an exponent.
constexpr double smallest_plain = 1e-4;
constexpr double largest_plain = 1e7;

void cut_zeros(std::string& text) {
  if (text.find('.') == std::string::npos) return;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
}

// Rounded to the last of so many digits of a number of the size `scale`, where that is a whole number; else the
// decimals that are written do it.
double rounded(double value, int digits, double scale) {
  if (digits == 0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(scale)) + 1 - digits);
  return unit > 1.0 ? unit * std::round(value / unit) : value;
}

}  // namespace

std::string significant(double value, int digits, double radius) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const int known = known_digits(digits, std::abs(value), radius);
  if (known < digits) value = rounded(value, known, std::abs(value));
  digits = known;
  if (value == 0.0) return "0";
  const double size = std::abs(value);
  if (size < smallest_plain || size >= largest_plain) return fmt::format("{:.{}e}", value, digits - 1);
  const int decimals = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size))));
  std::string text = fmt::format("{:.{}f}", value, decimals);
  cut_zeros(text);
  return text;
}

std::string small_number(double value) {
  if (std::isnan(value)) return "-";
  if (value == 0.0) return "0";
  if (std::abs(value) < 1e-16) return "<1e-16";
  return fmt::format("{:.1e}", value);
}

double to_rank(double value) {
  constexpr int bits = 30;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, bits)), exponent - bits);
}

int known_digits(int digits, double scale, double radius) {
  if (!(scale > 0.0) || !(radius > 0.0) || !std::isfinite(scale) || std::isinf(radius)) return digits;
  if (!(radius < scale)) return 0;
  // Rounding to the last digit adds half of its unit.
  const int order = static_cast<int>(std::floor(std::log10(scale)));
  const int last = static_cast<int>(std::ceil(std::log10(2 * radius)));
  return std::clamp(order - last + 1, 1, digits);
}

std::vector<std::string> aligned(const std::vector<double>& values, int digits, double scale, double radius) {
  const int known = known_digits(digits, scale, radius);
  const bool is_limited = known < digits;
  digits = known;
  const bool has_order = scale > 0.0 && std::isfinite(scale) && digits > 0;
  const bool plain = scale == 0.0 || (scale >= smallest_plain && scale < largest_plain);
  const int order = has_order ? static_cast<int>(std::floor(std::log10(scale))) : 0;
  const int decimals = !has_order || !plain ? 0 : std::max(0, digits - 1 - order);
  const double nothing = 0.5 * std::pow(10.0, order + 1 - digits);
  std::vector<std::string> texts;
  texts.reserve(values.size());
  for (double v : values) {
    if (is_limited && std::isfinite(v)) v = rounded(v, digits, scale);
    const bool is_nothing = v == 0.0 || std::abs(v) < nothing;
    if (is_nothing || !std::isfinite(v)) {
      // Padded as if it had a decimal point, so that it is aligned with the others.
      const std::size_t fraction = decimals > 0 ? decimals + 1 : 0;
      texts.push_back(significant(is_nothing ? 0.0 : v, digits) + std::string(fraction, ' '));
    } else {
      texts.push_back(plain ? fmt::format("{:.{}f}", v, decimals) : fmt::format("{:.{}e}", v, digits - 1));
    }
  }
  return texts;
}

std::vector<std::string> aligned(const std::vector<double>& values, int digits) {
  double largest = 0.0;
  for (double v : values) {
    if (std::isfinite(v)) largest = std::max(largest, std::abs(v));
  }
  return aligned(values, digits, largest);
}

ReadableUnit readable_unit(double size, const std::string& unit, double radius) {
  struct Prefixed {
    std::string_view unit, base;
    int exponent;
  };
  static constexpr std::array<Prefixed, 18> known = {{{"N", "N", 0},
                                                      {"kN", "N", 3},
                                                      {"MN", "N", 6},
                                                      {"m", "m", 0},
                                                      {"mm", "m", -3},
                                                      {"J", "J", 0},
                                                      {"W", "W", 0},
                                                      {"N m", "N m", 0},
                                                      {"N mm", "N m", -3},
                                                      {"kN m", "N m", 3},
                                                      {"kN mm", "N m", 0},
                                                      {"N/m", "N/m", 0},
                                                      {"N/mm", "N/m", 3},
                                                      {"kN/m", "N/m", 3},
                                                      {"kN/mm", "N/m", 6},
                                                      {"N m/rad", "N m/rad", 0},
                                                      {"N s/m", "N s/m", 0},
                                                      {"N m s/rad", "N m s/rad", 0}}};
  static constexpr std::array<std::string_view, 9> prefixes = {"p", "n", "µ", "m", "", "k", "M", "G", "T"};
  const bool plain = size == 0.0 || !std::isfinite(size) || (size >= smallest_plain && size < largest_plain) ||
                     known_digits(1, size, radius) == 0;
  const auto* const found =
      std::find_if(known.begin(), known.end(), [&](const Prefixed& prefixed) { return prefixed.unit == unit; });
  if (plain || found == known.end()) return {1.0, unit};
  // Rounding up to the next power is left to the digits that are written: 999.99996 kN stays.
  const int order = static_cast<int>(std::floor(std::log10(size))) + found->exponent;
  const int step = std::clamp(static_cast<int>(std::floor(order / 3.0)), -4, 4);
  return {std::pow(10.0, found->exponent - 3 * step),
          std::string(prefixes[static_cast<std::size_t>(step + 4)]) + std::string(found->base)};
}

std::size_t screen_width(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string duration(double microseconds) {
  if (std::isnan(microseconds)) return "-";
  if (microseconds < 1e3) return significant(microseconds, 3) + " µs";
  if (microseconds < 1e6) return significant(microseconds / 1e3, 3) + " ms";
  return significant(microseconds / 1e6, 3) + " s";
}

std::string listed(const std::vector<std::string>& names, std::string_view last_by) {
  if (names.size() < 2) return names.empty() ? "" : names.front();
  return fmt::format("{} {} {}", fmt::join(names.begin(), names.end() - 1, ", "), last_by, names.back());
}

std::string count(int number, std::string_view singular, std::string_view plural) {
  return fmt::format("{} {}", number, number == 1 ? singular : plural);
}

}  // namespace poise::app
