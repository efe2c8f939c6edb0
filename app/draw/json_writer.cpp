#include "app/draw/json_writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>

#include <fmt/format.h>

namespace poise::app {

void JsonWriter::separate() {
  if (!text_.empty() && text_.back() != '[' && text_.back() != '{' && text_.back() != ':') text_ += ',';
}

void JsonWriter::begin(char bracket) {
  separate();
  text_ += bracket;
}

void JsonWriter::key(std::string_view name) {
  separate();
  text_ += '"';
  text_ += name;
  text_ += "\":";
}

void JsonWriter::word(std::string_view word) {
  separate();
  text_ += '"';
  for (const char c : word) {
    if (static_cast<unsigned char>(c) < 0x20U) {
      fmt::format_to(std::back_inserter(text_), "\\u{:04x}", static_cast<unsigned>(c));
      continue;
    }
    if (c == '"' || c == '\\') text_ += '\\';
    text_ += c;
  }
  text_ += '"';
}

void JsonWriter::flag(bool is) { json(is ? "true" : "false"); }

void JsonWriter::integer(long long number) {
  separate();
  fmt::format_to(std::back_inserter(text_), "{}", number);
}

void JsonWriter::number(double value) {
  if (!std::isfinite(value)) return json("null");
  separate();
  fmt::format_to(std::back_inserter(text_), "{:.6g}", value + 0.0);
}

void JsonWriter::rounded(double value, int decimals) {
  static constexpr double powers[] = {1, 10, 100, 1000};
  constexpr double largest = 1e12;
  separate();
  long long n = std::isfinite(value) ? std::llround(std::clamp(value, -largest, largest) * powers[decimals]) : 0;
  if (n < 0) text_ += '-';
  n = std::abs(n);
  while (decimals > 0 && n % 10 == 0) {
    n /= 10;
    --decimals;
  }
  const auto unit = static_cast<long long>(powers[decimals]);
  fmt::format_to(std::back_inserter(text_), "{}", n / unit);
  if (decimals > 0) fmt::format_to(std::back_inserter(text_), ".{:0{}}", n % unit, decimals);
}

void JsonWriter::json(std::string_view value) {
  separate();
  text_ += value;
}

void JsonWriter::add(std::string_view name, std::string_view value) {
  key(name);
  word(value);
}

void JsonWriter::add(std::string_view name, const std::vector<double>& numbers) {
  key(name);
  begin('[');
  for (const double v : numbers) number(v);
  end(']');
}

}  // namespace poise::app
