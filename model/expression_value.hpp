#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "model/expression.hpp"
#include "model/select.hpp"

namespace poise {

/// x^y. A whole exponent that is a number multiplies, so that the base may have any sign.
template <class T>
T power_of(const T& x, const T& y, bool is_number, double exponent) {
  using std::exp;
  using std::log;
  constexpr double most = 64.0;
  if (!is_number || exponent != std::floor(exponent) || std::abs(exponent) > most) return exp(T(y * log(x)));
  T out(1);
  for (int k = 0; k < static_cast<int>(std::abs(exponent)); ++k) out = T(out * x);
  return exponent < 0.0 ? T(T(1) / out) : out;
}

/// f(x, y) of a function of expressions, by its name.
template <class T>
T function_value(std::string_view name, const T& x, const T& y) {
  using std::abs;
  using std::atan2;
  using std::cos;
  using std::exp;
  using std::log;
  using std::sin;
  using std::sqrt;
  if (name == "sqrt") return sqrt(x);
  if (name == "exp") return exp(x);
  if (name == "log") return log(x);
  if (name == "sin") return sin(x);
  if (name == "cos") return cos(x);
  if (name == "tan") return T(sin(x) / cos(x));
  if (name == "asin") return atan2(x, T(sqrt(T(T(1) - x * x))));
  if (name == "acos") return atan2(T(sqrt(T(T(1) - x * x))), x);
  if (name == "atan") return atan2(x, T(1));
  if (name == "abs") return abs(x);
  if (name == "atan2") return atan2(x, y);
  if (name == "hypot") return sqrt(T(x * x + y * y));
  if (name == "min") return select(x < y, x, y);
  return select(x > y, x, y);
}

template <class T>
T Expression::value_in(std::span<const T> numbers) const {
  std::vector<T> stack;
  bool is_number = false;  // the last step was one
  double last = 0.0;
  for (const Step& step : steps_) {
    const auto index = static_cast<std::size_t>(step.index);
    const bool was_number = is_number;
    is_number = step.operation == Operation::number;
    if (is_number) {
      last = step.number;
      stack.push_back(T(last));
      continue;
    }
    if (step.operation == Operation::name) {
      stack.push_back(numbers[index]);
      continue;
    }
    const bool has_one = step.operation == Operation::negative ||
                         (step.operation == Operation::function && arguments_of_function(step.index) == 1);
    T b(0);
    if (!has_one) {
      b = stack.back();
      stack.pop_back();
    }
    T& a = stack.back();
    switch (step.operation) {
      case Operation::negative:
        // The sign of a number makes a number of it.
        is_number = was_number;
        last = -last;
        a = T(-a);
        break;
      case Operation::add:
        a = T(a + b);
        break;
      case Operation::subtract:
        a = T(a - b);
        break;
      case Operation::multiply:
        a = T(a * b);
        break;
      case Operation::divide:
        a = T(a / b);
        break;
      case Operation::power:
        a = power_of(a, b, was_number, last);
        break;
      default:
        a = function_value(name_of_function(step.index), a, b);
    }
  }
  return stack.back();
}

}  // namespace poise
