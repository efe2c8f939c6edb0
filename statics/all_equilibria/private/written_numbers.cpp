#include "statics/all_equilibria/private/written_numbers.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "model/dependent_number.hpp"

namespace poise {
namespace {

Rational power_of_ten(int exponent) {
  const Rational power(boost::multiprecision::pow(boost::multiprecision::cpp_int(10), std::abs(exponent)));
  return exponent < 0 ? Rational(1 / power) : power;
}

// The number that fmt writes as "-1.25e-03".
Rational rational_of(const std::string& text) {
  const std::size_t e = text.find('e');
  std::string digits = text.substr(0, e);
  const std::size_t point = digits.find('.');
  const int decimals = point == std::string::npos ? 0 : static_cast<int>(digits.size() - point - 1);
  if (point != std::string::npos) digits.erase(point, 1);
  const bool negative = digits.front() == '-';
  if (negative) digits.erase(0, 1);
  digits.erase(0, std::min(digits.find_first_not_of('0'), digits.size() - 1));  // a leading zero makes an octal number
  const Rational size =
      Rational(boost::multiprecision::cpp_int(digits)) * power_of_ten(std::stoi(text.substr(e + 1)) - decimals);
  return negative ? Rational(-size) : size;
}

}  // namespace

Rational shortest_decimal(double x, double unit) {
  constexpr int most_digits = 17;
  for (int digits = 1; digits <= most_digits; ++digits) {
    const std::string text = fmt::format("{:.{}e}", x / unit, digits - 1);
    if (std::strtod(text.c_str(), nullptr) * unit == x) return rational_of(text);
  }
  return Rational(x) / Rational(unit);
}

bool is_written_in_numbers(const Scene& scene) {
  return !scene.dependents ||
         std::none_of(scene.dependents->begin(), scene.dependents->end(), [](const DependentNumber& one) {
           return one.at.place.owner != Owner::number && counts_in_statics(one.at.place.owner);
         });
}

}  // namespace poise
