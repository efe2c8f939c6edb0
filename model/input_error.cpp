#include "model/input_error.hpp"

#include <cstddef>

#include "model/one_line.hpp"

namespace poise {
namespace {

// The end has room for the longest list of keys.
constexpr std::size_t longest_line = 1000, kept_in_front = 490, kept_behind = 500;

std::string shortened(const std::string& line) {
  if (line.size() <= longest_line) return line;
  // Not within a letter of several bytes.
  const auto boundary = [&](std::size_t at) {
    while ((static_cast<unsigned char>(line[at]) & 0xC0U) == 0x80U) --at;
    return at;
  };
  return line.substr(0, boundary(kept_in_front)) + " ... " + line.substr(boundary(line.size() - kept_behind));
}

}  // namespace

InputError::InputError(const std::string& message) : std::runtime_error(shortened(one_line(message))) {}

}  // namespace poise
