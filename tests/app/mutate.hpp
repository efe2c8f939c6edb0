#pragma once

// Damage to files and words, for tests of bad input.

#include <cstddef>
#include <random>
#include <string>
#include <vector>

namespace poise::app_tests {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}

  /// 0 .. count - 1; the same on every platform.
  std::size_t below(std::size_t count) { return engine_() % count; }
  template <class List>
  const auto& of(const List& list) {
    return list[below(std::size(list))];
  }

 private:
  std::mt19937 engine_;
};

/// Numbers and what is no number, as they may be written where one is expected: "nan", "1e400", "0x10", "", ...
const std::vector<std::string>& odd_numbers();

/// A text damaged in one or a few of some forty ways (bytes, tokens, lines, structure, encoding); what was done to it
/// is added to `how`.
std::string mutated(std::string text, Random& random, std::string& how);

/// A word of a command line damaged in the same spirit; never contains a NUL byte or a slash that it did not have.
std::string mutated_word(std::string word, Random& random);

}  // namespace poise::app_tests
