#pragma once

#include <string>

#include "model/input_error.hpp"

namespace poise::test {

/// What the InputError says that call() throws; empty if it throws none.
template <class Call>
std::string message_of(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace poise::test
