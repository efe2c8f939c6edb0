#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace poise {

/// A number of a scene file that is written as a formula, "2*pi*r": + - * / ^ with the usual precedence, brackets,
/// numbers, the constant pi, names, and the functions
///   sqrt exp log sin cos tan asin acos atan abs   of one argument (log is the natural one, angles are in rad)
///   atan2 hypot min max                           of two
/// A sign binds less than ^ in front of a base (-2^2 = -4), more behind it (2^-1 = 0.5).
///
/// Parsed once (Boost.Spirit) to steps that are taken one after the other on a stack, so that it is evaluated without
/// allocation, in the order in which it is written, and by several threads at once.
class Expression {
 public:
  /// Throws InputError that says what was expected at which character. `names`: those that it may use. At most 1000
  /// characters, and 16 brackets inside each other.
  Expression(std::string_view text, const std::vector<std::string>& names);

  /// As it is written.
  const std::string& text() const { return text_; }
  /// Indices of the names that it uses, ascending.
  const std::vector<int>& uses() const { return uses_; }

  /// Its value; `numbers` are those of the names. Not a number, or infinite, where it has none.
  double value(std::span<const double> numbers) const;
  /// Its derivative where the names change at the rates `slopes`, exact but for rounding; not a number where it has
  /// none: at the kinks of abs, min and max, and where a value of a function begins.
  double slope(std::span<const double> numbers, std::span<const double> slopes) const;
  /// Its second derivative where the names change at these rates and these rise at the rates `bends`, as slope().
  double bend(std::span<const double> numbers, std::span<const double> slopes, std::span<const double> bends) const;

  /// Its value in another scalar, of sets of numbers an enclosure (model/expression_value.hpp).
  template <class T>
  T value_in(std::span<const T> numbers) const;
  /// 0 where it is the same for all numbers, 1 where it is proved to be affine in them, else 2. `of_names`: the same of
  /// what each name stands for.
  int degree(std::span<const int> of_names) const;

  /// Functions whose arguments use a name.
  std::vector<std::string_view> functions_of(int name) const;

  /// Whether a name may be given to a number: letters, digits and underscores, not a digit first, neither pi nor a
  /// function.
  static bool is_name(std::string_view name);

 private:
  friend class ExpressionParser;
  enum class Operation : unsigned char { number, name, negative, add, subtract, multiply, divide, power, function };
  struct Step {
    Operation operation = Operation::number;
    int index = 0;  // of the name or the function
    double number = 0.0;
  };
  struct Dual {
    double value = 0.0, slope = 0.0, bend = 0.0;
  };
  static std::string_view name_of_function(int index);
  static int arguments_of_function(int index);
  Dual evaluate(std::span<const double> numbers, std::span<const double> slopes, std::span<const double> bends) const;

  std::string text_;
  std::vector<int> uses_;
  std::vector<Step> steps_;
};

}  // namespace poise
