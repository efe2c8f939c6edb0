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

/// A function of x and y with its derivatives there; of those of one argument y is 0.
struct Function {
  std::string_view name;
  int arguments;
  double (*value)(double x, double y);
  double (*by_x)(double x, double y);
  double (*by_y)(double x, double y);
};

// The larger argument is the one that counts; at equal ones min and max have no derivative.
double step_of(double x, double y) { return x > y ? 1.0 : x < y ? 0.0 : undefined; }

constexpr std::array functions{
    Function{"sqrt", 1, [](double x, double) { return std::sqrt(x); },
             [](double x, double) { return 0.5 / std::sqrt(x); }, nullptr},
    Function{"exp", 1, [](double x, double) { return std::exp(x); }, [](double x, double) { return std::exp(x); },
             nullptr},
    Function{"log", 1, [](double x, double) { return std::log(x); }, [](double x, double) { return 1.0 / x; }, nullptr},
    Function{"sin", 1, [](double x, double) { return std::sin(x); }, [](double x, double) { return std::cos(x); },
             nullptr},
    Function{"cos", 1, [](double x, double) { return std::cos(x); }, [](double x, double) { return -std::sin(x); },
             nullptr},
    Function{"tan", 1, [](double x, double) { return std::tan(x); },
             [](double x, double) { return 1.0 + std::tan(x) * std::tan(x); }, nullptr},
    Function{"asin", 1, [](double x, double) { return std::asin(x); },
             [](double x, double) { return 1.0 / std::sqrt((1.0 - x) * (1.0 + x)); }, nullptr},
    Function{"acos", 1, [](double x, double) { return std::acos(x); },
             [](double x, double) { return -1.0 / std::sqrt((1.0 - x) * (1.0 + x)); }, nullptr},
    Function{"atan", 1, [](double x, double) { return std::atan(x); },
             [](double x, double) { return 1.0 / (1.0 + x * x); }, nullptr},
    Function{"abs", 1, [](double x, double) { return std::abs(x); },
             [](double x, double) { return x > 0.0   ? 1.0
                                           : x < 0.0 ? -1.0
                                                     : undefined; }, nullptr},
    Function{"atan2", 2, [](double y, double x) { return std::atan2(y, x); },
             [](double y, double x) { return x / (x * x + y * y); },
             [](double y, double x) { return -y / (x * x + y * y); }},
    Function{"hypot", 2, [](double x, double y) { return std::hypot(x, y); },
             [](double x, double y) { return x / std::hypot(x, y); },
             [](double x, double y) { return y / std::hypot(x, y); }},
    Function{"min", 2, [](double x, double y) { return x < y || std::isnan(x) ? x : y; },
             [](double x, double y) { return step_of(y, x); }, [](double x, double y) { return step_of(x, y); }},
    Function{"max", 2, [](double x, double y) { return x > y || std::isnan(x) ? x : y; },
             [](double x, double y) { return step_of(x, y); }, [](double x, double y) { return step_of(y, x); }},
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
const auto word = x3::raw[x3::lexeme[(x3::ascii::alpha | '_') >> *(x3::ascii::alnum | '_')]];
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

double Expression::value(std::span<const double> numbers) const { return evaluate(numbers, {}).value; }

double Expression::slope(std::span<const double> numbers, std::span<const double> slopes) const {
  return evaluate(numbers, slopes).slope;
}

bool Expression::is_name(std::string_view name) {
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  return !name.empty() && !is_digit(name.front()) && name != "pi" && function_called(name) < 0 &&
         std::all_of(name.begin(), name.end(), [&](char c) { return is_letter(c) || is_digit(c); });
}

Expression::Dual Expression::evaluate(std::span<const double> numbers, std::span<const double> slopes) const {
  std::array<Dual, stack_size> stack;
  std::size_t size = 0;
  for (const Step& step : steps_) {
    const auto index = static_cast<std::size_t>(step.index);
    if (step.operation == Operation::number) {
      stack[size++] = {step.number, 0.0};
      continue;
    }
    if (step.operation == Operation::name) {
      stack[size++] = {numbers[index], slopes.empty() ? 0.0 : slopes[index]};
      continue;
    }
    const bool has_one = step.operation == Operation::negative ||
                         (step.operation == Operation::function && functions[index].arguments == 1);
    const Dual b = has_one ? Dual{} : stack[--size];
    Dual& a = stack[size - 1];
    switch (step.operation) {
      case Operation::negative:
        a = {-a.value, -a.slope};
        break;
      case Operation::add:
        a = {a.value + b.value, a.slope + b.slope};
        break;
      case Operation::subtract:
        a = {a.value - b.value, a.slope - b.slope};
        break;
      case Operation::multiply:
        a = {a.value * b.value, product(b.value, a.slope) + product(a.value, b.slope)};
        break;
      case Operation::divide: {
        const double quotient = a.value / b.value;
        a = {quotient, product(1.0 / b.value, a.slope) - product(quotient / b.value, b.slope)};
        break;
      }
      case Operation::power: {
        const double whole = std::pow(a.value, b.value);
        a = {whole, product(b.value * std::pow(a.value, b.value - 1.0), a.slope) +
                        product(whole * std::log(a.value), b.slope)};
        break;
      }
      default: {
        const Function& f = functions[index];
        double slope = product(f.by_x(a.value, b.value), a.slope);
        if (f.by_y != nullptr) {
          // At equal slopes it does not matter which of two equal arguments min and max take.
          const bool is_tie = a.value == b.value && a.slope == b.slope && (f.name == "min" || f.name == "max");
          slope = is_tie ? a.slope : slope + product(f.by_y(a.value, b.value), b.slope);
        }
        a = {f.value(a.value, b.value), slope};
      }
    }
  }
  return stack[0];
}

}  // namespace poise
