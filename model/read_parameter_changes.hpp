#pragma once

// Private to the readers of files.

#include <vector>

#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// Reads the key `set` of a table, { "load.P" = 40 }, and applies the changes to the scene.
std::vector<ParameterChange> read_parameter_changes(const TomlTable& table, Scene& scene);

}  // namespace poise
