#pragma once

#include <string>

namespace poise {

/// The text as a TOML string.
std::string toml_string(const std::string& text);
/// A key of TOML, in quotes if necessary.
std::string toml_key(const std::string& name);
/// A float of TOML with all its digits: never written as an integer, which is limited to 64 bits.
std::string toml_number(double value);

}  // namespace poise
