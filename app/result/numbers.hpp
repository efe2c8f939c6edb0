#pragma once

// How numbers are written in text.

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/quantity.hpp"

namespace poise::app {

/// The value, or not a number, where there is none: a gap in columns, curves and CSV files.
inline double or_gap(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

/// `value` to so many significant digits: "0.1234", "12344", "1.234e-07" outside 1e-4 .. 1e7; zeros at the end cut. Not
/// a number is "-". Of a value that is known to within `radius` only known_digits() are written, "0" where there are
/// none: 12344 to within 400 is "12000".
std::string significant(double value, int digits, double radius = 0.0);

/// An error or a residual: "0", "<1e-16", or two digits "2.2e-16". Not a number is "-".
std::string small_number(double value);

/// As many digits, at most `digits` and at least one, as leave the last of a number of the size `scale` right to one if
/// the number is known to within `radius`; none where that is not less than `scale`. All where the radius is infinite:
/// then nothing is proved, which has to be said elsewhere.
int known_digits(int digits, double scale, double radius);

/// The value to 30 bits, by which rows are put in order: those that differ by rounding only stay as they are.
double to_rank(double value);

/// A column of numbers with their decimal points aligned, as many decimals as give a number of the size `scale` so many
/// significant digits; what rounds to zero is "0", not a number is "-". Of values that are known to within `radius` no
/// more is written than known_digits() of `scale`.
std::vector<std::string> aligned(const std::vector<double>& values, int digits, double scale, double radius = 0.0);
/// The same with the largest of the values as scale.
std::vector<std::string> aligned(const std::vector<double>& values, int digits);

/// A unit in which numbers of some size are read easily, and the factor to it.
struct ReadableUnit {
  double factor = 1.0;
  std::string unit;
};

/// From 1e-4 to 1e7, and of 0, the unit itself; else, where it is a unit of force, moment, length, energy, power or
/// stiffness that takes prefixes, with the prefix that leaves 1 to 1000: 22 080 000 N is 22.08 MN. The unit itself too
/// where no digit is known, because `radius`, in that unit, is not less than the size.
ReadableUnit readable_unit(double size, const std::string& unit, double radius = 0.0);

/// Places that a text takes on the screen: its letters, read as UTF-8.
std::size_t screen_width(std::string_view text);

/// A span of time: "0.84 µs", "12.3 ms", "4.56 s".
std::string duration(double microseconds);

/// "a", "a and b", "a, b and c", with whatever word joins the last.
std::string listed(const std::vector<std::string>& names, std::string_view last_by = "and");

/// "1 body", "3 bodies".
std::string count(int number, std::string_view singular, std::string_view plural);

}  // namespace poise::app
