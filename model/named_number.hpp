#pragma once

// Numbers given to names in one word: "load.P=40".

#include <optional>
#include <string>
#include <string_view>

namespace poise {

/// The number that the whole text is, with or without a sign; empty where it is none. "inf" and "nan" are numbers here:
/// whoever sets a range refuses them by it.
std::optional<double> read_number(std::string_view text);

struct NamedText {
  std::string name;
  std::string text;
};

/// Reads "NAME=TEXT", split at the last "=". Throws InputError that names `option` and what it expects: "--set load.P:
/// there is no "="; expected PATH=NUMBER, say load.P=40".
NamedText read_named_text(const std::string& option, const std::string& given, const std::string& expected);

struct NamedNumber {
  std::string name;
  double value = 0.0;
};

/// Reads "NAME=NUMBER". Throws InputError in the same way.
NamedNumber read_named_number(const std::string& option, const std::string& given, const std::string& expected);

}  // namespace poise
