#include "app/present/csv.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace poise::app {
namespace {

// The shortest text of a double takes at most 24 letters: -2.2250738585072014e-308.
constexpr std::size_t longest_number = 24;

std::string quoted(const std::string& text) {
  const bool plain = !text.empty() && text.find_first_of(",;\"\t\r\n") == std::string::npos && text.front() != ' ' &&
                     text.back() != ' ';
  if (plain) return text;
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

void append(std::string& text, double value) {
  if (!std::isfinite(value)) return;
  std::array<char, longest_number> number{};
  const auto written = std::to_chars(number.data(), number.data() + number.size(), value);
  text.append(number.data(), written.ptr);
}

}  // namespace

std::string csv_text(const Table& table) {
  std::vector<const Column*> columns;
  std::string text;
  for (const Column& column : table.columns) {
    if (column.key.empty()) continue;
    text += (columns.empty() ? "" : ",") + quoted(column.key);
    columns.push_back(&column);
  }
  if (columns.empty()) return "";
  text += '\n';
  text.reserve((table.size() + 1) * columns.size() * (longest_number - 4));
  for (std::size_t row = 0; row < table.size(); ++row) {
    for (const Column* column : columns) {
      if (column != columns.front()) text += ',';
      if (column->is_words())
        text += quoted(column->words[row]);
      else
        append(text, column->numbers[row]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace poise::app
