#pragma once

// The option --vary of commands that follow equilibria.

#include <string>

#include "app/commands/options.hpp"
#include "model/input_error.hpp"
#include "statics/model/varied_scene.hpp"

namespace poise::app {

/// Names the option in what make() says of bad input, but of a scene that cannot be assembled.
template <class Make>
auto naming_vary(Make make) {
  try {
    return make();
  } catch (const AssemblyError&) {
    throw;
  } catch (const InputError& error) {
    throw InputError(std::string("--vary ") + error.what());
  }
}

/// Reads "load.P=0..5". Throws InputError.
NamedRange read_vary_range(const std::string& text);

/// The scene of a request with that number varying over its range. Throws InputError.
VariedScene load_varied_scene(const Request& request, const NamedRange& range);

}  // namespace poise::app
