#include "app/csv_file.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace poise::app {
namespace {

// The shortest text of a double takes at most 24 letters: -2.2250738585072014e-308.
constexpr std::size_t longest_number = 24;

std::string quoted(const std::string& name) {
  const bool plain = !name.empty() && name.find_first_of(",;\"\t\r\n") == std::string::npos && name.front() != ' ' &&
                     name.back() != ' ';
  if (plain) return name;
  std::string text = "\"";
  for (char c : name) {
    if (c == '"') text += '"';
    text += c;
  }
  return text + "\"";
}

}  // namespace

std::string csv_text(const std::vector<std::string>& header, const std::vector<std::vector<double>>& columns,
                     const std::vector<std::vector<std::string>>& words) {
  if (columns.empty()) return "";
  const std::size_t rows = columns.front().size();
  std::string text;
  text.reserve((rows + 1) * columns.size() * (longest_number - 4));
  for (const std::string& name : header) text += (text.empty() ? "" : ",") + quoted(name);
  text += '\n';
  std::array<char, longest_number> number{};
  for (std::size_t row = 0; row < rows; ++row) {
    for (const std::vector<std::string>& column : words) text += quoted(column[row]) + ',';
    for (std::size_t column = 0; column < columns.size(); ++column) {
      if (column > 0) text += ',';
      const double value = columns[column][row];
      if (!std::isfinite(value)) continue;
      const auto written = std::to_chars(number.data(), number.data() + number.size(), value);
      text.append(number.data(), written.ptr);
    }
    text += '\n';
  }
  return text;
}

}  // namespace poise::app
