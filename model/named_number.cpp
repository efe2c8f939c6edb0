#include "model/named_number.hpp"

#include <charconv>
#include <system_error>

#include "model/input_error.hpp"

namespace poise {

std::optional<double> read_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

NamedText read_named_text(const std::string& option, const std::string& given, const std::string& expected) {
  const std::size_t equals = given.rfind('=');
  if (equals == std::string::npos) {
    throw InputError(option + " " + given + ": there is no \"=\"; expected " + expected);
  }
  return {given.substr(0, equals), given.substr(equals + 1)};
}

NamedNumber read_named_number(const std::string& option, const std::string& given, const std::string& expected) {
  const NamedText parts = read_named_text(option, given, expected);
  const std::optional<double> value = read_number(parts.text);
  if (!value) {
    throw InputError(option + " " + given + ": \"" + parts.text + "\" is not a number; expected " + expected);
  }
  return {parts.name, *value};
}

}  // namespace poise
