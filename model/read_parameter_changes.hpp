#pragma once

// Private to the readers of files.

#include <vector>

#include "model/parameter_change.hpp"
#include "model/scene.hpp"
#include "model/toml_reader.hpp"

namespace poise {

/// The key `set` of a table, { "load.P" = 40 }: changes, which are made in the scene as well.
std::vector<ParameterChange> read_parameter_changes(const TomlTable& table, Scene& scene);

}  // namespace poise
