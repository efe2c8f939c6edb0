#include "identification/set_parameter.hpp"

#include <charconv>
#include <string_view>
#include <system_error>

namespace poise {

void set_parameter(Scene& scene, const std::string& change) {
  const auto fail = [&](const std::string& message) { throw InputError("--set " + message); };
  const std::string example = "; expected PATH=NUMBER, say load.P=40";
  const std::size_t equals = change.rfind('=');
  if (equals == std::string::npos) fail(change + ": there is no \"=\"" + example);
  const std::string_view digits = std::string_view(change).substr(equals + 1);
  const char* begin = digits.data();
  const char* const end = begin + digits.size();
  if (begin != end && *begin == '+') ++begin;
  double value = 0.0;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (error != std::errc() || stopped != end) {
    fail(change + ": \"" + std::string(digits) + "\" is not a number" + example);
  }
  try {
    set_value(scene, std::string_view(change).substr(0, equals), value);
  } catch (const InputError& e) {
    fail(e.what());
  }
}

}  // namespace poise
