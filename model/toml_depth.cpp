#include "model/toml_depth.hpp"

#include <algorithm>
#include <cstddef>

namespace poise {
namespace {

constexpr int most_levels = 16;

/// Where a string ends that begins at `at` with one quote or three; npos where it does not end. The parser fails there.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const std::string_view three = quote == '"' ? "\"\"\"" : "'''";
  const bool is_long = text.substr(at).starts_with(three);
  for (std::size_t i = at + (is_long ? 3 : 1); i < text.size(); ++i) {
    if (text[i] == '\\' && quote == '"') {
      ++i;
    } else if (text[i] == '\n' && !is_long) {
      break;
    } else if (text[i] == quote && !is_long) {
      return i + 1;
    } else if (text.substr(i).starts_with(three)) {
      // Up to two quotes more belong to the string.
      i += 3;
      for (int more = 0; more < 2 && i < text.size() && text[i] == quote; ++more) ++i;
      return i;
    }
  }
  return std::string_view::npos;
}

}  // namespace

std::optional<TooDeep> find_too_deep(std::string_view toml) {
  int brackets = 0, dots = 0, line = 1;
  for (std::size_t at = 0; at < toml.size();) {
    const char c = toml[at];
    if (c == '#') {
      at = std::min(toml.find('\n', at), toml.size());
      continue;
    }
    if (c == '"' || c == '\'') {
      const std::size_t end = end_of_string(toml, at);
      if (end == std::string_view::npos) return std::nullopt;
      line += static_cast<int>(std::count(toml.begin() + at, toml.begin() + end, '\n'));
      at = end;
      continue;
    }
    if (c == '[' || c == '{') ++brackets;
    if (c == ']' || c == '}') --brackets;
    // Dots between bare keys, strings and blanks join the parts of one key; anything else ends it.
    dots = c == '.' ? dots + 1 : std::string_view("[]{}=,\n").find(c) != std::string_view::npos ? 0 : dots;
    if (dots >= most_levels)
      return TooDeep{"expected a key of at most 16 parts; put a name that holds dots in quotes", line};
    if (brackets > most_levels) return TooDeep{"expected at most 16 brackets inside each other; close some", line};
    line += c == '\n';
    ++at;
  }
  return std::nullopt;
}

}  // namespace poise
