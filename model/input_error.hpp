#pragma once

#include <stdexcept>
#include <string>

namespace poise {

/// An error in the user's input: one line "file:line: item: what was expected; a likely fix". The command line then
/// ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  /// Keeps the message as one_line() of at most 1000 bytes: of a longer one the middle is left out, so that the place
  /// in front and the fix behind a very long name stay.
  explicit InputError(const std::string& message);
};

}  // namespace poise
