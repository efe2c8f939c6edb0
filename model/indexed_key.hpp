#pragma once

// Keys of numbers that are counted: "force.1", "curve.2.x".

#include <array>
#include <cstddef>
#include <string_view>

namespace poise {

/// A key with a number in it, of which keys of Number are parts; so it must be a constant.
struct IndexedKey {
  std::array<char, 16> text{};
  std::size_t size = 0;

  constexpr std::string_view view() const { return {text.data(), size}; }
};

/// "WORD.K", or "WORD.K.PART", with K = 1 to `Count`, below 100.
template <std::size_t Count>
constexpr std::array<IndexedKey, Count> indexed_keys(std::string_view word, std::string_view part = {}) {
  static_assert(Count < 100);
  std::array<IndexedKey, Count> out{};
  for (std::size_t k = 0; k < Count; ++k) {
    IndexedKey& key = out[k];
    const auto add = [&](char c) { key.text[key.size++] = c; };
    for (const char c : word) add(c);
    add('.');
    if (k + 1 >= 10) add(static_cast<char>('0' + (k + 1) / 10));
    add(static_cast<char>('0' + (k + 1) % 10));
    if (part.empty()) continue;
    add('.');
    for (const char c : part) add(c);
  }
  return out;
}

}  // namespace poise
