#pragma once

#include <optional>
#include <string_view>

namespace poise {

/// What is nested too deep in a TOML text, with its line. Parsing and releasing a document takes stack for every level,
/// so that depth has to be bounded before either.
struct TooDeep {
  const char* message = "";  ///< "expected at most 16 ...; ..."
  int line = 0;
};

/// The first key of more than 16 parts, or 17th bracket inside each other; empty where there is none before the first
/// syntax error.
std::optional<TooDeep> find_too_deep(std::string_view toml);

}  // namespace poise
