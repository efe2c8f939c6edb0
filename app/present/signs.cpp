#include "app/present/signs.hpp"

#include <cctype>
#include <cstddef>
#include <string_view>

namespace poise::app {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Whether a number may begin behind this: a blank, a bracket, a sign; no letter, digit or dot, as in "arm-2" or 1e-9.
bool begins_number_behind(char c) { return std::string_view(" ([,:;/<>+\n").find(c) != std::string_view::npos; }

}  // namespace

std::string with_true_signs(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool before_number = i + 1 < text.size() && is_digit(text[i + 1]);
    const bool is_free = out.empty() || begins_number_behind(text[i - 1]);
    if (text[i] == '+' && i + 1 < text.size() && text[i + 1] == '-' && is_free) {
      out += "\u00b1";
      ++i;
    } else if (text[i] == '-' && before_number && is_free) {
      out += "\u2212";
    } else {
      out += text[i];
    }
  }
  return out;
}

}  // namespace poise::app
