#pragma once

#include <stdexcept>

namespace poise {

/// An error in the user's input: one line "file:line: item: what was expected; a likely fix". The command line then
/// ends with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace poise
