#include "app/commands/method_options.hpp"

#include <algorithm>
#include <sstream>

#include "app/commands/scene_options.hpp"

namespace poise::app {
namespace {

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const MethodTraits& method : all_methods()) names.emplace_back(method.name);
  return names;
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

}  // namespace poise::app
