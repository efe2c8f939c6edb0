#pragma once

// The option --vary of commands that follow equilibria.

#include <functional>
#include <string>
#include <vector>

#include "app/commands/options.hpp"
#include "app/terminal/progress.hpp"
#include "model/input_error.hpp"
#include "statics/model/varied_scene.hpp"
#include "statics/paths/path.hpp"

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

/// The words of --from, and where a path begins by such a word. Throws InputError.
std::vector<std::string> from_words();
PathOptions::From read_from(const std::string& word);

/// Shows how far a path has come. Refers to both.
std::function<void(double, int)> progress_of(Progress& progress, const VariedScene& varied);

}  // namespace poise::app
