#include "model/expression.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include <boost/spirit/home/x3.hpp>

#include "model/input_error.hpp"
#include "model/nearest_name.hpp"

namespace poise {
namespace {

constexpr std::size_t most_characters = 1000;
constexpr int most_brackets = 16;
// Each bracket leaves at most a summand, a factor, a base and an argument waiting for it.
constexpr std::size_t stack_size = 4 * (most_brackets + 2);
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// The second derivatives of a function of x and y.
struct Second {
  double xx = 0.0, xy = 0.0, yy = 0.0;
};

/// A function of x and y with its derivatives there; of those of one argument y is 0.
struct Function {
  std::string_view name;
  int arguments;
  double (*value)(double x, double y);
  double (*by_x)(double x, double y);
  double (*by_y)(double x, double y);
  Second (*second)(double x, double y);
};

// The larger argument is the one that counts; at equal ones min and max have no derivative.
double step_of(double x, double y) { return x > y ? 1.0 : x < y ? 0.0 : undefined; }

Second no_bend_but_at_ties(double x, double y) {
  const double none = x == y ? undefined : 0.0;
  return {none, none, none};
}

constexpr std::array functions{
    Function{"sqrt", 1, [](double x, double) { return std::sqrt(x); },
             [](double x, double) { return 0.5 / std::sqrt(x); }, nullptr,
             [](double x, double) { return Second{-0.25 / (x * std::sqrt(x))}; }},
    Function{"exp", 1, [](double x, double) { return std::exp(x); }, [](double x, double) { return std::exp(x); },
             nullptr, [](double x, double) { return Second{std::exp(x)}; }},
    Function{"log", 1, [](double x, double) { return std::log(x); }, [](double x, double) { return 1.0 / x; }, nullptr,
             [](double x, double) { return Second{-1.0 / (x * x)}; }},
    Function{"sin", 1, [](double x, double) { return std::sin(x); }, [](double x, double) { return std::cos(x); },
             nullptr, [](double x, double) { return Second{-std::sin(x)}; }},
    Function{"cos", 1, [](double x, double) { return std::cos(x); }, [](double x, double) { return -std::sin(x); },
             nullptr, [](double x, double) { return Second{-std::cos(x)}; }},
    Function{"tan", 1, [](double x, double) { return std::tan(x); },
             [](double x, double) { return 1.0 + std::tan(x) * std::tan(x); }, nullptr,
             [](double x, double) { return Second{2.0 * std::tan(x) * (1.0 + std::tan(x) * std::tan(x))}; }},
    Function{"asin", 1, [](double x, double) { return std::asin(x); },
             [](double x, double) { return 1.0 / std::sqrt((1.0 - x) * (1.0 + x)); }, nullptr,
             [](double x, double) {
               const double square = (1.0 - x) * (1.0 + x);
               return Second{x / (square * std::sqrt(square))};
             }},
    Function{"acos", 1, [](double x, double) { return std::acos(x); },
             [](double x, double) { return -1.0 / std::sqrt((1.0 - x) * (1.0 + x)); }, nullptr,
             [](double x, double) {
               const double square = (1.0 - x) * (1.0 + x);
               return Second{-x / (square * std::sqrt(square))};
             }},
    Function{"atan", 1, [](double x, double) { return std::atan(x); },
             [](double x, double) { return 1.0 / (1.0 + x * x); }, nullptr,
             [](double x, double) { return Second{-2.0 * x / ((1.0 + x * x) * (1.0 + x * x))}; }},
    Function{"abs", 1, [](double x, double) { return std::abs(x); },
             [](double x, double) { return x > 0.0   ? 1.0
                                           : x < 0.0 ? -1.0
                                                     : undefined; }, nullptr,
             [](double x, double) { return Second{x == 0.0 ? undefined : 0.0}; }},
    Function{"atan2", 2, [](double y, double x) { return std::atan2(y, x); },
             [](double y, double x) { return x / (x * x + y * y); },
             [](double y, double x) { return -y / (x * x + y * y); },
             [](double y, double x) {
               const double square = x * x + y * y, over = square * square;
               return Second{-2.0 * x * y / over, (y * y - x * x) / over, 2.0 * x * y / over};
             }},
    Function{"hypot", 2, [](double x, double y) { return std::hypot(x, y); },
             [](double x, double y) { return x / std::hypot(x, y); },
             [](double x, double y) { return y / std::hypot(x, y); },
             [](double x, double y) {
               const double r = std::hypot(x, y), a = x / r, b = y / r;
               return Second{b * b / r, -a * b / r, a * a / r};
             }},
    Function{"min", 2, [](double x, double y) { return x < y || std::isnan(x) ? x : y; },
             [](double x, double y) { return step_of(y, x); }, [](double x, double y) { return step_of(x, y); },
             no_bend_but_at_ties},
    Function{"max", 2, [](double x, double y) { return x > y || std::isnan(x) ? x : y; },
             [](double x, double y) { return step_of(x, y); }, [](double x, double y) { return step_of(y, x); },
             no_bend_but_at_ties},
};

int function_called(std::string_view name) {
  const auto found =
      std::find_if(functions.begin(), functions.end(), [&](const Function& f) { return f.name == name; });
  return found == functions.end() ? -1 : static_cast<int>(found - functions.begin());
}

// What does not change has no derivative, whatever multiplies it.
double product(double derivative, double slope) { return slope == 0.0 ? 0.0 : derivative * slope; }

}  // namespace

/// What the grammar's actions do while a text is read.
class ExpressionParser {
 public:
  using Operation = Expression::Operation;

  ExpressionParser(Expression& out, const std::vector<std::string>& names) : out_(out), names_(names) {}

  void run();

  void take_number(std::string_view digits) {
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc()) fail("a number that a double can hold", quoted(digits), digits.data());
    out_.steps_.push_back({Operation::number, 0, value});
  }
  void take_name(std::string_view name) {
    if (name == "pi") return out_.steps_.push_back({Operation::number, 0, std::numbers::pi});
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) {
      if (function_called(name) >= 0) fail("\"(\" behind " + std::string(name), "none", name.data());
      fail_name(name);
    }
    const int index = static_cast<int>(found - names_.begin());
    out_.steps_.push_back({Operation::name, index});
    out_.uses_.push_back(index);
  }
  void begin_call(std::string_view name) {
    const int function = function_called(name);
    if (function < 0) fail_call(name);
    calls_.push_back({function, 1, name.data()});
  }
  void next_argument() { ++calls_.back().arguments; }
  void end_call() {
    const Call call = calls_.back();
    calls_.pop_back();
    const Function& function = functions[static_cast<std::size_t>(call.function)];
    if (call.arguments != function.arguments) {
      fail(function.arguments == 1 ? "one argument of " + std::string(function.name)
                                   : "two arguments of " + std::string(function.name),
           std::to_string(call.arguments), call.at);
    }
    out_.steps_.push_back({Operation::function, call.function});
  }
  void take(Operation operation) { out_.steps_.push_back({operation}); }

 private:
  struct Call {
    int function;
    int arguments;
    const char* at;
  };

  static std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

  [[noreturn]] void fail(const std::string& expected, const std::string& found, const char* at) const {
    throw InputError("expected " + expected + ", found " + found + " at character " +
                     std::to_string(at - out_.text_.data() + 1) + " of " + quoted(out_.text_));
  }
  [[noreturn]] void fail_call(std::string_view name) const {
    std::vector<std::string> known;
    for (const Function& function : functions) known.emplace_back(function.name);
    throw InputError("expected a function in front of \"(\", found " + quoted(name) + " in " + quoted(out_.text_) +
                     did_you_mean_or_list(name, known));
  }
  [[noreturn]] void fail_name(std::string_view name) const {
    std::vector<std::string> known = names_;
    known.emplace_back("pi");
    for (const Function& function : functions) known.emplace_back(function.name);
    throw InputError("expected a name of [numbers], pi or a function, found " + quoted(name) + " in " +
                     quoted(out_.text_) + did_you_mean_or_list(name, known));
  }

  Expression& out_;
  const std::vector<std::string>& names_;
  std::vector<Call> calls_;
};

namespace {
namespace grammar {

namespace x3 = boost::spirit::x3;

struct ParserTag;

template <class Context>
ExpressionParser& parser_of(const Context& context) {
  return x3::get<ParserTag>(context);
}

template <class Context>
std::string_view text_of(const Context& context) {
  const auto& range = x3::_attr(context);
  return {&*range.begin(), static_cast<std::size_t>(range.end() - range.begin())};
}

constexpr auto take_number = [](auto& context) { parser_of(context).take_number(text_of(context)); };
constexpr auto take_name = [](auto& context) { parser_of(context).take_name(text_of(context)); };
constexpr auto begin_call = [](auto& context) { parser_of(context).begin_call(text_of(context)); };
constexpr auto next_argument = [](auto& context) { parser_of(context).next_argument(); };
constexpr auto end_call = [](auto& context) { parser_of(context).end_call(); };
template <ExpressionParser::Operation operation>
constexpr auto take = [](auto& context) { parser_of(context).take(operation); };

using Operation = ExpressionParser::Operation;

const x3::rule<class SumRule> sum = "sum";
const x3::rule<class FactorRule> factor = "factor";
const x3::rule<class PowerRule> power = "power";
const x3::rule<class OperandRule> operand = "operand";

const auto digits = +x3::ascii::digit;
const auto number = x3::raw[x3::lexeme[((digits >> -('.' >> *x3::ascii::digit)) | (x3::char_('.') >> digits)) >>
                                       -(x3::char_("eE") >> -x3::char_("+-") >> digits)]];
const auto letter = x3::ascii::alnum | '_';
// Those of parts of a scene have dots.
const auto word = x3::raw[x3::lexeme[(x3::ascii::alpha | '_') >> *letter >> *('.' >> +letter)]];
const auto called = x3::raw[x3::lexeme[(x3::ascii::alpha | '_') >> *(x3::ascii::alnum | '_')]] >> &x3::lit('(');

const auto operand_def =
    number[take_number] |
    ((called[begin_call] >> '(') > sum > *((',' > x3::eps[next_argument]) > sum) > x3::lit(')')[end_call]) |
    word[take_name] | ('(' > sum > ')');
const auto power_def = operand >> -('^' > (('-' > operand > x3::eps[take<Operation::negative>]) | operand) >
                                    x3::eps[take<Operation::power>]);
const auto factor_def = ('-' > power > x3::eps[take<Operation::negative>]) | ('+' > power) | power;
const auto product_of = factor >> *(('*' > factor > x3::eps[take<Operation::multiply>]) |
                                    ('/' > factor > x3::eps[take<Operation::divide>]));
const auto sum_def = product_of >> *(('+' > product_of > x3::eps[take<Operation::add>]) |
                                     ('-' > product_of > x3::eps[take<Operation::subtract>]));

BOOST_SPIRIT_DEFINE(sum, factor, power, operand)

}  // namespace grammar
}  // namespace

void ExpressionParser::run() {
  namespace x3 = boost::spirit::x3;
  const std::string& text = out_.text_;
  if (text.size() > most_characters) {
    throw InputError("expected an expression of at most 1000 characters, found " + std::to_string(text.size()) +
                     "; give parts of it names in [numbers]");
  }
  int depth = 0;
  for (const char c : text) {
    depth += c == '(' ? 1 : c == ')' ? -1 : 0;
    if (depth > most_brackets) throw InputError("expected at most 16 brackets inside each other; close some");
  }
  const char* at = text.data();
  const char* const end = at + text.size();
  try {
    x3::phrase_parse(at, end, x3::with<grammar::ParserTag>(std::ref(*this))[x3::eps > grammar::sum > x3::eoi],
                     x3::ascii::space);
  } catch (const x3::expectation_failure<const char*>& failure) {
    at = failure.where();
    while (at != end && x3::ascii::space_type{}.test(*at, x3::unused)) ++at;
    const char* after = at == end ? end : at + 1;
    while (after != end && (static_cast<unsigned char>(*after) & 0xC0U) == 0x80U) ++after;  // of one letter in UTF-8
    const std::string& which = failure.which();
    fail(which == "eoi"   ? "an operator or the end"
         : which == "')'" ? "an operator or \")\""
                          : "a number, a name or \"(\"",
         at == end ? "its end" : quoted({at, static_cast<std::size_t>(after - at)}), at);
  }
}

Expression::Expression(std::string_view text, const std::vector<std::string>& names) : text_(text) {
  ExpressionParser(*this, names).run();
  std::sort(uses_.begin(), uses_.end());
  uses_.erase(std::unique(uses_.begin(), uses_.end()), uses_.end());
}

double Expression::value(std::span<const double> numbers) const { return evaluate(numbers, {}, {}).value; }

double Expression::slope(std::span<const double> numbers, std::span<const double> slopes) const {
  return evaluate(numbers, slopes, {}).slope;
}

double Expression::bend(std::span<const double> numbers, std::span<const double> slopes,
                        std::span<const double> bends) const {
  return evaluate(numbers, slopes, bends).bend;
}

std::string_view Expression::name_of_function(int index) { return functions[static_cast<std::size_t>(index)].name; }

int Expression::arguments_of_function(int index) { return functions[static_cast<std::size_t>(index)].arguments; }

int Expression::degree(std::span<const int> of_names) const {
  constexpr int more = 2;
  std::array<int, stack_size> stack{};
  std::size_t size = 0;
  for (const Step& step : steps_) {
    const auto index = static_cast<std::size_t>(step.index);
    switch (step.operation) {
      case Operation::number:
        stack[size++] = 0;
        continue;
      case Operation::name:
        stack[size++] = of_names[index];
        continue;
      case Operation::negative:
        continue;
      default:
        break;
    }
    const bool has_one = step.operation == Operation::function && functions[index].arguments == 1;
    const int b = has_one ? 0 : stack[--size];
    int& a = stack[size - 1];
    const bool is_sum = step.operation == Operation::add || step.operation == Operation::subtract;
    const bool is_scaled = (step.operation == Operation::multiply && (a == 0 || b == 0)) ||
                           (step.operation == Operation::divide && b == 0);
    const bool is_constant = a == 0 && b == 0;
    a = is_sum || is_scaled ? std::max(a, b) : is_constant ? 0 : more;
  }
  return stack[0];
}

std::vector<std::string_view> Expression::functions_of(int name) const {
  std::vector<std::string_view> out;
  std::vector<bool> uses;
  for (const Step& step : steps_) {
    const bool is_function = step.operation == Operation::function;
    if (step.operation == Operation::number || step.operation == Operation::name) {
      uses.push_back(step.operation == Operation::name && step.index == name);
      continue;
    }
    const bool has_one =
        step.operation == Operation::negative || (is_function && arguments_of_function(step.index) == 1);
    if (!has_one) {
      const bool last = uses.back();
      uses.pop_back();
      uses.back() = uses.back() || last;
    }
    if (is_function && uses.back()) out.push_back(name_of_function(step.index));
  }
  return out;
}

bool Expression::is_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && !is_digit(name.front()) && name != "pi" && function_called(name) < 0 &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || is_digit(c); });
}

// Along a change of the names, with ' for derivatives along it:
//   f(a, b)'  = f_a a' + f_b b'
//   f(a, b)'' = f_a a'' + f_b b'' + f_aa a'^2 + 2 f_ab a' b' + f_bb b'^2.
Expression::Dual Expression::evaluate(std::span<const double> numbers, std::span<const double> slopes,
                                      std::span<const double> bends) const {
  std::array<Dual, stack_size> stack;
  std::size_t size = 0;
  for (const Step& step : steps_) {
    const auto index = static_cast<std::size_t>(step.index);
    if (step.operation == Operation::number) {
      stack[size++] = {step.number, 0.0, 0.0};
      continue;
    }
    if (step.operation == Operation::name) {
      stack[size++] = {numbers[index], slopes.empty() ? 0.0 : slopes[index], bends.empty() ? 0.0 : bends[index]};
      continue;
    }
    const bool has_one = step.operation == Operation::negative ||
                         (step.operation == Operation::function && functions[index].arguments == 1);
    const Dual b = has_one ? Dual{} : stack[--size];
    Dual& a = stack[size - 1];
    const double squares[] = {a.slope * a.slope, 2.0 * a.slope * b.slope, b.slope * b.slope};
    // From the derivatives by a and b; most callers ask for no bend, and give none.
    const auto along = [&](double value, double by_a, double by_b, auto second) {
      Dual out{value, product(by_a, a.slope) + product(by_b, b.slope), 0.0};
      if (bends.empty()) return out;
      const Second s = second();
      out.bend = product(by_a, a.bend) + product(by_b, b.bend) + product(s.xx, squares[0]) + product(s.xy, squares[1]) +
                 product(s.yy, squares[2]);
      return out;
    };
    switch (step.operation) {
      case Operation::negative:
        a = {-a.value, -a.slope, -a.bend};
        break;
      case Operation::add:
        a = {a.value + b.value, a.slope + b.slope, a.bend + b.bend};
        break;
      case Operation::subtract:
        a = {a.value - b.value, a.slope - b.slope, a.bend - b.bend};
        break;
      case Operation::multiply:
        a = along(a.value * b.value, b.value, a.value, [] { return Second{0.0, 1.0, 0.0}; });
        break;
      case Operation::divide: {
        const double over = 1.0 / b.value, quotient = a.value / b.value;
        a = along(quotient, over, -quotient / b.value, [&] {
          return Second{0.0, -over * over, 2.0 * quotient * over * over};
        });
        break;
      }
      case Operation::power: {
        const double x = a.value, y = b.value, whole = std::pow(x, y), lower = std::pow(x, y - 1.0);
        // What does not change counts for nothing: the logarithm of a negative base, say.
        const double log = b.slope == 0.0 && b.bend == 0.0 ? 0.0 : std::log(x);
        a = along(whole, y * lower, whole * log, [&] {
          const double xx = y == 0.0 || y == 1.0 ? 0.0 : y * (y - 1.0) * std::pow(x, y - 2.0);
          return Second{xx, lower * (1.0 + y * log), whole * log * log};
        });
        break;
      }
      default: {
        const Function& f = functions[index];
        // At equal slopes it does not matter which of two equal arguments min and max take.
        if (a.value == b.value && a.slope == b.slope && a.bend == b.bend && (f.name == "min" || f.name == "max")) break;
        a = along(f.value(a.value, b.value), f.by_x(a.value, b.value),
                  f.by_y != nullptr ? f.by_y(a.value, b.value) : 0.0, [&] { return f.second(a.value, b.value); });
      }
    }
  }
  return stack[0];
}

}  // namespace poise
