#pragma once

#include <stdexcept>

namespace poise {

/// Something is wrong with what the user gave: one line "file:line: item: what was expected; a likely fix".
/// The command line answers it with exit code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace poise
