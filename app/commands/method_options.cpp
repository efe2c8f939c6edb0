#include "app/commands/method_options.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "app/commands/scene_options.hpp"
#include "model/input_error.hpp"
#include "model/named_number.hpp"

namespace poise::app {
namespace {

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodTraits& method : all_methods()) names.emplace_back(method.name);
  return names;
}

constexpr double tightest = 1e-20, loosest = 1.0;

double read_tolerance(std::string_view text) {
  const std::optional<double> value = read_number(text);
  const std::string expected = "expected numbers as in 1e-2..1e-14 or 1e-3,1e-6";
  // A point in front is what is left of three between two numbers.
  if (!value || text.starts_with('.')) {
    throw InputError(fmt::format("--tolerances: \"{}\" is not a number; {}", text, expected));
  }
  if (!(*value >= tightest && *value < loosest)) {
    throw InputError(
        fmt::format("--tolerances: expected numbers from {:g} to less than {:g}, found {}", tightest, loosest, text));
  }
  return *value;
}

std::vector<double> decades(std::string_view from, std::string_view to) {
  const double first = read_tolerance(from), last = read_tolerance(to);
  if (first < last) {
    throw InputError(
        fmt::format("--tolerances: {}..{} rises; expected the loosest first, say {}..{}", from, to, to, from));
  }
  constexpr double rounding = 1e-9;
  std::vector<double> out;
  for (double value = first; value >= last * (1 - rounding); value /= 10) {
    // Read back from 12 digits, so that 1e-5 is the number 1e-5.
    out.push_back(std::stod(fmt::format("{:.12g}", value)));
  }
  return out;
}

}  // namespace

std::string method_help() {
  std::string text;
  for (const MethodTraits& method : all_methods()) {
    text += (text.empty() ? "" : "\n") + std::string(method.name) + ": " + method.what;
  }
  return text;
}

Method read_method(const std::string& option, const std::string& name) {
  return all_methods()[chosen(option, name, method_names())].method;
}

std::vector<Method> read_methods(const std::string& option, const std::string& names) {
  std::vector<Method> methods;
  if (names == "all") {
    for (const MethodTraits& method : all_methods()) methods.push_back(method.method);
    return methods;
  }
  std::vector<std::string> known = method_names();
  known.emplace_back("all");
  // A comma at the end leaves an empty name behind it, which getline would not give.
  std::istringstream list(names + (names.empty() || names.back() == ',' ? "," : ""));
  for (std::string name; std::getline(list, name, ',');) {
    const std::size_t place = chosen(option, name, known);
    if (place + 1 == known.size()) return read_methods(option, "all");
    const Method method = all_methods()[place].method;
    if (std::find(methods.begin(), methods.end(), method) == methods.end()) methods.push_back(method);
  }
  return methods;
}

std::vector<double> read_tolerances(const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots != std::string::npos) {
    const std::string_view all = text;
    return decades(all.substr(0, dots), all.substr(dots + 2));
  }
  std::vector<double> out;
  // A comma at the end leaves an empty value behind it, which getline would not give.
  std::istringstream list(text + (text.empty() || text.back() == ',' ? "," : ""));
  for (std::string value; std::getline(list, value, ',');) out.push_back(read_tolerance(value));
  std::sort(out.begin(), out.end(), std::greater<>());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

}  // namespace poise::app
