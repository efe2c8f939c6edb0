#include "exchange/private/reading.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "model/input_error.hpp"
#include "model/named_number.hpp"
#include "model/one_line.hpp"

namespace poise {

void fail_at(const std::string& file, int line, const std::string& item, const std::string& message) {
  const std::string place = line > 0 ? fmt::format("{}:{}: ", file, line) : file + ": ";
  throw InputError(place + (item.empty() ? "" : item + ": ") + message);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> out;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    out.push_back(line);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return out;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::string in_small_letters(std::string_view text) {
  std::string out(text);
  for (char& letter : out) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  return out;
}

double number_at(std::string_view word, const std::string& file, int line, const std::string& item) {
  const std::optional<double> value = read_number(trimmed(word));
  if (!value) fail_at(file, line, item, fmt::format("expected a number, found \"{}\"", one_line(word)));
  // In any unit a scene can have these.
  constexpr double least = 1e-40, most = 1e40;
  if (!(*value == 0.0 || (std::abs(*value) >= least && std::abs(*value) <= most))) {
    fail_at(file, line, item, fmt::format("expected 0 or a number of {:g} to {:g}, found {}", least, most, *value));
  }
  return *value == 0.0 ? 0.0 : *value;  // of -0 the sign means nothing
}

std::string own_name(std::string_view name, std::unordered_set<std::string>& taken) {
  constexpr std::size_t longest = 100;
  std::string base = one_line(trimmed(name.substr(0, longest)));
  if (base.empty()) base = "unnamed";
  std::string out = base;
  for (int k = 2; !taken.insert(out).second; ++k) out = fmt::format("{} {}", base, k);
  return out;
}

std::string name_beside(std::string_view name, std::unordered_set<std::string>& taken) {
  std::string allowed(name.substr(0, std::min<std::size_t>(name.size(), 1000)));
  for (char& letter : allowed) {
    if (letter == '.' || letter == '"' || letter == '\\') letter = '_';
  }
  return own_name(allowed, taken);
}

std::string point_name(std::size_t index) {
  constexpr std::size_t letters = 26;
  const std::string letter(1, static_cast<char>('A' + index % letters));
  return index < letters ? letter : letter + std::to_string(index / letters + 1);
}

}  // namespace poise
