#pragma once

// What the fuzz targets share. Each target is a program of libFuzzer (clang, -fsanitize=fuzzer) that hands bytes to one
// reader: whatever they are, they are read, or refused by an InputError of one line.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <unistd.h>

#include "model/input_error.hpp"

namespace poise::fuzz {

inline std::string_view text_of(const std::uint8_t* bytes, std::size_t count) {
  return {reinterpret_cast<const char*>(bytes), count};  // NOLINT(cppcoreguidelines-pro-type-reinterpret-cast)
}

/// A folder for the files of one target, in TMPDIR; another process has another.
inline std::filesystem::path folder() {
  static const std::filesystem::path own = [] {
    std::filesystem::path path = std::filesystem::temp_directory_path() / fmt::format("poise-fuzz-{}", ::getpid());
    std::filesystem::create_directories(path);
    return path;
  }();
  return own;
}

inline std::filesystem::path written(const char* name, std::string_view text) {
  const std::filesystem::path path = folder() / name;
  std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
  return path;
}

/// Ends the program, which libFuzzer reports together with the input.
inline void expect(bool holds, const std::string& why) {
  if (holds) return;
  fmt::print(stderr, "not as expected: {}\n", why);
  std::abort();
}

/// Calls f, and expects of an InputError that it is one line.
template <class F>
bool reads(F f) {
  try {
    f();
    return true;
  } catch (const InputError& error) {
    const std::string message = error.what();
    expect(!message.empty() && message.find('\n') == std::string::npos, "a message of several lines: " + message);
    return false;
  }
}

}  // namespace poise::fuzz
