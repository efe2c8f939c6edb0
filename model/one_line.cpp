#include "model/one_line.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace poise {
namespace {

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0U) == 0x80U; }

struct Letter {
  std::size_t bytes = 0;  ///< 0: the text does not begin with valid UTF-8
  std::uint32_t code = 0;
};

/// The first letter of a text that is not empty.
Letter first_letter(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80U) return {1, lead};
  const std::size_t bytes = lead >= 0xF0U ? 4 : lead >= 0xE0U ? 3 : 2;
  if (lead < 0xC2U || lead > 0xF4U || text.size() < bytes) return {};
  std::uint32_t code = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if (!is_continuation(text[i])) return {};
    code = code << 6U | (static_cast<unsigned char>(text[i]) & 0x3FU);
  }
  const bool too_long = (bytes == 3 && code < 0x800U) || (bytes == 4 && code < 0x10000U);
  const bool surrogate = code >= 0xD800U && code < 0xE000U;
  if (too_long || surrogate || code > 0x10FFFFU) return {};
  return {bytes, code};
}

}  // namespace

std::string one_line(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Letter letter = first_letter(text);
    const bool is_control = letter.code < 0x20U || (letter.code >= 0x7FU && letter.code < 0xA0U);
    if (letter.bytes == 0) {
      out += '?';
    } else if (is_control) {
      out += ' ';
    } else {
      out += text.substr(0, letter.bytes);
    }
    text.remove_prefix(letter.bytes == 0 ? 1 : letter.bytes);
  }
  return out;
}

std::string words_of_key(std::string_view key) {
  std::string words(key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

}  // namespace poise
